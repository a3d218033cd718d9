// Binary glTF 2.0: the triangles of the default scene with their nodes' transforms, as one mesh.
#include <pelage/error.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/mesh_formats.h"

namespace pelage::io {
namespace {

using Json = nlohmann::json;

constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr std::size_t kMaxDepth = 256;          // of nodes
constexpr std::size_t kMaxVertices = 1u << 26;  // of all instances together: about 2 GiB
enum ComponentType { kByte = 5120, kUnsignedByte, kShort, kUnsignedShort, kUnsignedInt = 5125, kFloat };
enum Mode { kTriangles = 4, kStrip, kFan };

std::size_t component_bytes(int type) {
  switch (type) {
    case kByte:
    case kUnsignedByte: return 1;
    case kShort:
    case kUnsignedShort: return 2;
    case kUnsignedInt:
    case kFloat: return 4;
    default: return 0;
  }
}

// Row-major affine map in double, so that chains of nodes do not lose the exporter's digits.
struct Matrix {
  double m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
};

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      r.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j] + (j == 3 ? a.m[i][3] : 0);
  return r;
}

Vec3 point(const Matrix& a, Vec3 p) {
  const auto row = [&](int i) { return static_cast<float>(a.m[i][0] * p.x + a.m[i][1] * p.y + a.m[i][2] * p.z + a.m[i][3]); };
  return {row(0), row(1), row(2)};
}

// Normals go by the cofactors (inverse transpose up to a factor); a mirror turns them and the winding.
Matrix cofactors(const Matrix& a) {
  Matrix c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c.m[i][j] = a.m[i1][j1] * a.m[i2][j2] - a.m[i1][j2] * a.m[i2][j1];
    }
  return c;
}

double determinant(const Matrix& a, const Matrix& c) {
  return a.m[0][0] * c.m[0][0] + a.m[0][1] * c.m[0][1] + a.m[0][2] * c.m[0][2];
}

class GlbReader {
 public:
  explicit GlbReader(const ByteSource& source) : name_(source.name()), source_(source) {}

  TriangleMesh read() {
    read_chunks();
    try {
      read_scene();
    } catch (const Json::exception& e) {
      throw Error(name_, "JSON chunk", e.what(), "the file is damaged; export it again");
    }
    if (!any_uv_) mesh_.uv.clear();
    return std::move(mesh_);
  }

 private:
  void read_chunks() {
    if (source_.get<std::uint32_t>(4, "version") != 2) fail("header", "not version 2", "export glTF 2.0");
    source_.require(0, source_.get<std::uint32_t>(8, "length"), "glb container");
    const std::uint64_t end = source_.get<std::uint32_t>(8, "length");
    for (std::uint64_t at = 12; at + 8 <= end;) {
      const std::uint64_t bytes = source_.get<std::uint32_t>(at, "chunk length");
      const auto kind = source_.get<std::uint32_t>(at + 4, "chunk type");
      source_.require(at + 8, bytes, "chunk");
      if (kind == kJsonChunk && root_.is_null()) {
        std::string text(bytes, '\0');
        source_.read(at + 8, bytes, text.data(), "JSON chunk");
        root_ = Json::parse(text, nullptr, false);
        if (!root_.is_object()) fail("JSON chunk", "not valid JSON");
      } else if (kind == kBinaryChunk && binary_.empty()) {
        binary_.resize(bytes);
        source_.read(at + 8, bytes, binary_.data(), "binary chunk");
      }
      at += 8 + (bytes + 3) / 4 * 4;
    }
    if (root_.is_null()) fail("", "no JSON chunk");
  }

  void read_scene() {
    if (root_.contains("extensionsRequired") && !root_["extensionsRequired"].empty())
      fail("extensionsRequired", fmt::format("extension {} is needed", root_["extensionsRequired"][0].dump()),
           "export without compression");
    if (!root_.contains("scenes")) {
      for (std::size_t n = 0; n < array("nodes").size(); ++n) add_node(n, Matrix(), 0);
      return;
    }
    for (const Json& node : item("scenes", integer(root_, "scene", 0)).value("nodes", Json::array()))
      add_node(integer(node), Matrix(), 0);
  }

  void add_node(std::size_t index, const Matrix& parent, std::size_t depth) {
    if (depth > kMaxDepth) fail(fmt::format("node {}", index), "nodes nested too deeply, or in a circle");
    if (++visited_ > kMaxVertices) fail(fmt::format("node {}", index), "too many node instances");
    const Json& node = item("nodes", index);
    const Matrix world = parent * local_transform(node);
    if (node.contains("mesh")) {
      const std::size_t mesh = integer(node["mesh"]);
      for (const Json& primitive : item("meshes", mesh).at("primitives")) add_primitive(primitive, world, mesh);
    }
    // Only a tree is valid glTF, so children never repeat: a circle or a diamond would grow without bound.
    for (const Json& child : node.value("children", Json::array())) {
      const auto c = integer(child);
      if (c >= array("nodes").size()) fail(fmt::format("node {}", index), fmt::format("child {} does not exist", c));
      has_parent_.resize(array("nodes").size());
      if (has_parent_[c]) fail(fmt::format("node {}", c), "a child of two nodes");
      has_parent_[c] = true;
      add_node(c, world, depth + 1);
    }
  }

  static Matrix local_transform(const Json& node) {
    Matrix a;
    if (node.contains("matrix")) {
      const auto m = node["matrix"].get<std::array<double, 16>>();  // column-major
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) a.m[i][j] = m[static_cast<std::size_t>(4 * j + i)];
      return a;
    }
    const auto t = node.value("translation", std::array<double, 3>{0, 0, 0});
    const auto q = node.value("rotation", std::array<double, 4>{0, 0, 0, 1});
    const auto s = node.value("scale", std::array<double, 3>{1, 1, 1});
    const auto [x, y, z, w] = q;
    const double rotation[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                                   {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                                   {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) a.m[i][j] = rotation[i][j] * s[j];
      a.m[i][3] = t[i];
    }
    return a;
  }

  void add_primitive(const Json& primitive, const Matrix& world, std::size_t mesh) {
    const std::size_t mode = integer(primitive, "mode", kTriangles);
    if (mode < kTriangles || mode > kFan) return;  // points and lines
    const Json& attributes = primitive.at("attributes");
    const auto base = static_cast<std::uint32_t>(mesh_.positions.size());
    const std::size_t count = add_positions(attributes, world, mesh);
    add_normals(attributes, cofactors(world), count);
    add_uv(attributes, count);

    std::vector<std::uint32_t> indices;
    if (primitive.contains("indices")) {
      const Accessor a = accessor(integer(primitive["indices"]), 1);
      if (a.type != kUnsignedByte && a.type != kUnsignedShort && a.type != kUnsignedInt)
        fail("indices", fmt::format("component type {}; indices are unsigned integers", a.type));
      indices.resize(a.count);
      for (std::size_t i = 0; i < a.count; ++i) indices[i] = static_cast<std::uint32_t>(component(a, i, 0));
    } else {
      indices.resize(count);
      for (std::size_t i = 0; i < count; ++i) indices[i] = static_cast<std::uint32_t>(i);
    }
    for (const std::uint32_t i : indices)
      if (i >= count) fail(fmt::format("mesh {}", mesh), fmt::format("vertex index {} of {}", i, count));
    const bool mirrored = determinant(world, cofactors(world)) < 0;
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      mesh_.triangles.push_back({base + a, base + (mirrored ? c : b), base + (mirrored ? b : c)});
    };
    for (std::size_t i = 0; i + 2 < indices.size(); i += mode == kTriangles ? 3 : 1) {
      if (mode == kTriangles) add(indices[i], indices[i + 1], indices[i + 2]);
      if (mode == kStrip) add(indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]);
      if (mode == kFan) add(indices[0], indices[i + 1], indices[i + 2]);
    }
    if (mesh_.triangles.size() > 2 * kMaxVertices) fail("", "too many triangles in all instances together");
  }

  std::size_t add_positions(const Json& attributes, const Matrix& world, std::size_t mesh) {
    const Accessor a = accessor(integer(attributes.at("POSITION")), 3);
    if (mesh_.positions.size() + a.count > kMaxVertices)
      fail(fmt::format("mesh {}", mesh), fmt::format("more than {} vertices in all instances together", kMaxVertices));
    for (std::size_t i = 0; i < a.count; ++i) mesh_.positions.push_back(point(world, vec3(a, i)));
    return a.count;
  }

  void add_normals(const Json& attributes, const Matrix& turn, std::size_t count) {
    const std::size_t begin = mesh_.normals.size();
    mesh_.normals.resize(begin + count);
    if (!attributes.contains("NORMAL")) return;
    const Accessor a = accessor(integer(attributes["NORMAL"]), 3);
    if (a.count != count) fail("NORMAL", "not as many as positions");
    for (std::size_t i = 0; i < count; ++i) mesh_.normals[begin + i] = normalize(point(turn, vec3(a, i)));
  }

  void add_uv(const Json& attributes, std::size_t count) {
    const std::size_t begin = mesh_.uv.size();
    mesh_.uv.resize(begin + count);
    if (!attributes.contains("TEXCOORD_0")) return;
    const Accessor a = accessor(integer(attributes["TEXCOORD_0"]), 2);
    if (a.count != count) fail("TEXCOORD_0", "not as many as positions");
    any_uv_ = true;
    for (std::size_t i = 0; i < count; ++i)
      mesh_.uv[begin + i] = {static_cast<float>(component(a, i, 0)), static_cast<float>(1 - component(a, i, 1))};
  }

  // A checked view of the binary chunk: every component of every item lies inside.
  struct Accessor {
    const char* data = nullptr;  // null: all zero
    std::size_t count = 0, stride = 0;
    int type = 0;
    bool normalized = false;
  };

  Accessor accessor(std::size_t index, std::size_t components) const {
    const Json& json = item("accessors", index);
    const std::string place = fmt::format("accessor {}", index);
    static constexpr std::array<const char*, 3> kTypes = {"SCALAR", "VEC2", "VEC3"};
    Accessor a;
    a.count = integer(json.at("count"));
    a.type = static_cast<int>(integer(json.at("componentType")));
    a.normalized = json.value("normalized", false);
    const std::size_t item_bytes = component_bytes(a.type) * components;
    if (json.at("type") != kTypes[components - 1] || item_bytes == 0) fail(place, "of another type than its use needs");
    if (json.contains("sparse")) fail(place, "sparse accessors are not supported", "export without morph targets");
    const Json& view = item("bufferViews", integer(json.at("bufferView")));
    if (view.at("buffer") != 0 || item("buffers", 0).contains("uri"))
      fail(place, "its data are not in this file", "export one .glb with its buffers embedded");
    const auto view_begin = integer(view, "byteOffset", 0), view_bytes = integer(view.at("byteLength"));
    const auto begin = integer(json, "byteOffset", 0);
    a.stride = integer(view, "byteStride", item_bytes);
    if (view_begin > binary_.size() || view_bytes > binary_.size() - view_begin)
      fail(place, fmt::format("its view ends after the {} bytes of the binary chunk", binary_.size()));
    const bool fits = a.stride >= item_bytes && (a.count == 0 || (begin <= view_bytes && item_bytes <= view_bytes - begin &&
                                                                  a.count - 1 <= (view_bytes - begin - item_bytes) / a.stride));
    if (!fits) fail(place, fmt::format("{} items do not fit its view of {} bytes", a.count, view_bytes));
    a.data = binary_.data() + view_begin + begin;
    return a;
  }

  template <class T>
  static double load(const char* at, bool normalized) {
    T value;
    std::memcpy(&value, at, sizeof(T));
    const auto number = static_cast<double>(value);
    return normalized ? std::max(number / std::numeric_limits<T>::max(), -1.) : number;
  }

  static double component(const Accessor& a, std::size_t i, std::size_t c) {
    const char* const at = a.data + i * a.stride + c * component_bytes(a.type);
    switch (a.type) {
      case kByte: return load<std::int8_t>(at, a.normalized);
      case kUnsignedByte: return load<std::uint8_t>(at, a.normalized);
      case kShort: return load<std::int16_t>(at, a.normalized);
      case kUnsignedShort: return load<std::uint16_t>(at, a.normalized);
      case kUnsignedInt: return load<std::uint32_t>(at, false);
      default: return load<float>(at, false);
    }
  }

  static Vec3 vec3(const Accessor& a, std::size_t i) {
    return {static_cast<float>(component(a, i, 0)), static_cast<float>(component(a, i, 1)),
            static_cast<float>(component(a, i, 2))};
  }

  // A count or an index; a JSON number with a sign or a fraction is neither.
  std::size_t integer(const Json& json) const {
    if (!json.is_number_unsigned()) fail("JSON chunk", fmt::format("{} where a count or index belongs", json.dump()));
    return json.get<std::size_t>();
  }
  std::size_t integer(const Json& object, const char* key, std::size_t fallback) const {
    const auto found = object.find(key);
    return found == object.end() ? fallback : integer(*found);
  }

  const Json& array(const char* key) const {
    static const Json kEmpty = Json::array();
    const auto found = root_.find(key);
    return found == root_.end() ? kEmpty : *found;
  }
  const Json& item(const char* key, std::size_t index) const {
    const Json& all = array(key);
    if (!all.is_array() || index >= all.size()) fail(key, fmt::format("number {} of {} is referred to", index, all.size()));
    return all[index];
  }

  [[noreturn]] void fail(const std::string& place, const std::string& problem,
                         const char* remedy = "the file is damaged; export it again") const {
    throw Error(name_, place, problem, remedy);
  }

  const std::string& name_;
  const ByteSource& source_;
  Json root_;
  std::vector<char> binary_;
  std::vector<bool> has_parent_;
  std::size_t visited_ = 0;
  TriangleMesh mesh_;
  bool any_uv_ = false;
};

}  // namespace

TriangleMesh read_glb(const ByteSource& source) { return GlbReader(source).read(); }

}  // namespace pelage::io
