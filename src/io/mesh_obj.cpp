// Wavefront OBJ: v, vt, vn, f; polygons become fans, everything else is skipped.
#include <pelage/error.h>

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string_view>
#include <unordered_map>

#include "io/mesh_formats.h"
#include "io/text_words.h"

namespace pelage::io {
namespace {

constexpr std::uint32_t kNone = UINT32_MAX;

// A corner of a face: indices of position, texture coordinate and normal; one vertex per combination.
struct Corner {
  std::uint32_t position = kNone, uv = kNone, normal = kNone;
  bool operator==(const Corner&) const = default;
};
struct CornerHash {
  std::size_t operator()(const Corner& c) const {
    std::uint64_t h = c.position * 0x9E3779B97F4A7C15ull;
    h = (h ^ c.uv) * 0xC2B2AE3D27D4EB4Full;
    h = (h ^ c.normal) * 0x165667B19E3779F9ull;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
};

class ObjReader {
 public:
  explicit ObjReader(const ByteSource& source) : name_(source.name()), text_(source.read_all()) {}

  TriangleMesh read() {
    std::string_view rest(text_.data(), text_.size());
    if (rest.find('\0') != std::string_view::npos)
      throw Error(name_, "", "binary data, not an OBJ text", "OBJ, PLY, glb and tfxmesh are read");
    while (!rest.empty()) {
      ++line_number_;
      read_line(Words(take_line(rest)));
    }
    if (mesh_.triangles.empty())
      throw Error(name_, "", "no faces", positions_.empty() ? "is it a mesh? OBJ, PLY, glb and tfxmesh are read" : "");
    if (!all_have_uv_) mesh_.uv.clear();
    return std::move(mesh_);
  }

 private:
  void read_line(Words line) {
    const std::string_view key = line.next();
    if (key == "v") {
      const Vec3 p = vec3(line);
      positions_.push_back(p);
    } else if (key == "vt") {
      const float u = number(line.next());
      const std::string_view v = line.next();
      uvs_.emplace_back(u, v.empty() ? 0 : number(v));
    } else if (key == "vn") {
      normals_.push_back(normalize(vec3(line)));
    } else if (key == "f") {
      face(line);
    }
  }

  Vec3 vec3(Words& line) const {
    const float x = number(line.next()), y = number(line.next());
    return {x, y, number(line.next())};
  }

  float number(std::string_view word) const {
    const std::optional<float> value = float_from(word);
    if (!value) fail(fmt::format("'{}' is no number", word));
    return *value;
  }

  // OBJ counts from 1, and from the last one backwards with negative numbers. "" is no index.
  std::uint32_t index(std::string_view word, std::size_t count, const char* what) const {
    if (word.empty()) return kNone;
    const std::optional<std::int64_t> told = integer_from<std::int64_t>(word);
    if (!told) fail(fmt::format("'{}' is no index", word));
    const std::int64_t value = *told, from_zero = value > 0 ? value - 1 : static_cast<std::int64_t>(count) + value;
    if (value == 0 || from_zero < 0 || from_zero >= static_cast<std::int64_t>(count))
      fail(fmt::format("{} {} of {}", what, value, count));
    return static_cast<std::uint32_t>(from_zero);
  }

  Corner corner(std::string_view word) const {
    const auto part = [&] {
      const std::size_t slash = std::min(word.find('/'), word.size());
      const std::string_view found = word.substr(0, slash);
      word.remove_prefix(std::min(slash + 1, word.size()));
      return found;
    };
    Corner c;
    c.position = index(part(), positions_.size(), "vertex");
    c.uv = index(part(), uvs_.size(), "texture coordinate");
    c.normal = index(part(), normals_.size(), "normal");
    if (c.position == kNone) fail("a corner without a vertex");
    return c;
  }

  void face(Words& line) {
    std::uint32_t first = kNone, previous = kNone;
    int corners = 0;
    for (std::string_view word = line.next(); !word.empty(); word = line.next(), ++corners) {
      const std::uint32_t vertex = vertex_of(corner(word));
      if (corners == 0) first = vertex;
      if (corners >= 2) mesh_.triangles.push_back({first, previous, vertex});
      previous = vertex;
    }
    if (corners < 3) fail(fmt::format("a face of {} corners", corners));
  }

  std::uint32_t vertex_of(const Corner& c) {
    const auto [entry, fresh] = vertices_.try_emplace(c, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (fresh) {
      mesh_.positions.push_back(positions_[c.position]);
      mesh_.uv.push_back(c.uv == kNone ? Vec2() : uvs_[c.uv]);
      mesh_.normals.push_back(c.normal == kNone ? Vec3() : normals_[c.normal]);
      all_have_uv_ &= c.uv != kNone;
    }
    return entry->second;
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw Error(name_, fmt::format("line {}", line_number_), problem, "the file is damaged or no OBJ mesh");
  }

  const std::string& name_;
  std::vector<char> text_;
  std::size_t line_number_ = 0;
  std::vector<Vec3> positions_, normals_;
  std::vector<Vec2> uvs_;
  std::unordered_map<Corner, std::uint32_t, CornerHash> vertices_;
  TriangleMesh mesh_;
  bool all_have_uv_ = true;
};

}  // namespace

TriangleMesh read_obj(const ByteSource& source) { return ObjReader(source).read(); }

}  // namespace pelage::io
