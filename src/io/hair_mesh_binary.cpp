// `.hairmesh`: a header of counts, then arrays without padding in the order in which for_each_part() names them.
#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "io/hair_mesh_formats.h"
#include "io/xxh64.h"

namespace pelage::io {
namespace {

constexpr std::array<char, 8> kMagic = {'\x89', 'H', 'M', 'E', 'S', 'H', '\r', '\n'};
constexpr std::uint16_t kMajor = 1, kMinor = 0;

enum Flag : std::uint32_t {
  kFloatPlaces = 1,
  kTangents = 2,
  kWideUvw = 4,
  kOcclusion = 8,
  kWideOcclusion = 16,
  kKnownFlags = 31
};

struct Header {
  std::array<char, 8> magic;
  std::uint16_t major, minor;
  std::uint32_t flags;
  std::uint32_t columns, vertices, bundles, styles;
  float width;
  std::uint32_t comment_bytes;
  std::uint64_t file_size;
  std::uint64_t checksum;  // of all bytes but these eight
};
static_assert(sizeof(Header) == 56 && offsetof(Header, checksum) == 48);

bool has(const Header& header, Flag flag) { return (header.flags & flag) != 0; }

// The box in which 16 bits name a place; its corners are themselves such places, so that a file that is read and written
// again stays the same.
float place_in(float lower, float upper, std::uint16_t q) {
  const float t = static_cast<float>(q) / 65535.f;
  return lower * (1 - t) + upper * t;
}
std::uint16_t nearest_place(float lower, float upper, float x) {
  const double extent = static_cast<double>(upper) - static_cast<double>(lower);
  if (!(extent > 0)) return 0;
  const double t = (static_cast<double>(x) - static_cast<double>(lower)) / extent;
  return static_cast<std::uint16_t>(std::lround(std::clamp(t, 0., 1.) * 65535));
}
constexpr float kTangentSteps = 32767;

// Numbers 0…1 in one byte or two.
template <class T>
float share_of(T q) {
  return static_cast<float>(q) / static_cast<float>(static_cast<T>(~T{0}));
}
template <class T>
T nearest_share(float x) {
  return static_cast<T>(std::lround(x * static_cast<float>(static_cast<T>(~T{0}))));
}

class Writer {
 public:
  Writer(const HairMesh& mesh, const HairMeshPrecision& precision) : mesh_(mesh) {
    header_.magic = kMagic, header_.major = kMajor, header_.minor = kMinor;
    header_.flags = (precision.float_positions ? kFloatPlaces : 0u) | (mesh.tangents.empty() ? 0u : kTangents) |
                    (precision.wide_attributes ? kWideUvw | kWideOcclusion : 0u) | (mesh.occlusion.empty() ? 0u : kOcclusion);
    header_.columns = static_cast<std::uint32_t>(mesh.column_count());
    header_.vertices = static_cast<std::uint32_t>(mesh.vertex_count());
    header_.bundles = static_cast<std::uint32_t>(mesh.bundles.size());
    header_.styles = static_cast<std::uint32_t>(mesh.styles.size());
    header_.width = mesh.width;
    header_.comment_bytes = static_cast<std::uint32_t>(mesh.comment.size());
    put(header_);
    put_layers();
    put_positions();
    if (has(header_, kTangents)) put_tangents();
    for (const Vec3 p : mesh.uvw)
      for (const float x : {p.x, p.y, p.z}) put_share(x);
    for (const float x : mesh.occlusion) put_share(x);
    put_bundles();
    put_styles();
    bytes_ += mesh.comment;
    seal();
  }
  const std::string& bytes() const { return bytes_; }

 private:
  template <class T>
  void put(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void put_share(float x) {
    if (has(header_, kWideUvw)) put(nearest_share<std::uint16_t>(x));
    else put(nearest_share<std::uint8_t>(x));
  }
  void put_layers() {
    for (std::size_t c = 0; c < mesh_.column_count(); ++c)
      put(static_cast<std::uint8_t>(mesh_.column_offsets[c + 1] - mesh_.column_offsets[c]));
  }
  void put_positions() {
    if (has(header_, kFloatPlaces)) return put_floats(mesh_.positions);
    Bounds box;
    for (const Vec3 p : mesh_.positions) box.extend(p);
    put(box.lower), put(box.upper);
    for (const Vec3 p : mesh_.positions) {
      put(nearest_place(box.lower.x, box.upper.x, p.x));
      put(nearest_place(box.lower.y, box.upper.y, p.y));
      put(nearest_place(box.lower.z, box.upper.z, p.z));
    }
  }
  void put_tangents() {
    if (has(header_, kFloatPlaces)) return put_floats(mesh_.tangents);
    float largest = 0;
    for (const Vec3 t : mesh_.tangents) largest = std::max({largest, std::fabs(t.x), std::fabs(t.y), std::fabs(t.z)});
    put(largest);
    for (const Vec3 t : mesh_.tangents)
      for (const float x : {t.x, t.y, t.z})
        put(static_cast<std::int16_t>(
            largest > 0 ? std::lround(static_cast<double>(x) / static_cast<double>(largest) * kTangentSteps) : 0));
  }
  void put_floats(const std::vector<Vec3>& vectors) {
    bytes_.append(reinterpret_cast<const char*>(vectors.data()), vectors.size() * sizeof(Vec3));
  }
  void put_bundles() {
    for (const HairMesh::Bundle& b : mesh_.bundles) {
      for (const std::uint32_t column : b.columns)
        if (header_.columns <= 65536) put(static_cast<std::uint16_t>(column));
        else put(column);
      put(b.strands), put(b.style), put(b.seed);
    }
  }
  void put_styles() {
    for (const auto& style : mesh_.styles) {
      put(static_cast<std::uint8_t>(style.size()));
      for (const StyleOperator& o : style) put(o.kind), put(o.amount), put(o.frequency), put(o.start), put(o.variation);
    }
  }
  void seal() {
    header_.file_size = bytes_.size();
    std::memcpy(bytes_.data(), &header_, sizeof header_);
    header_.checksum = hair_mesh_checksum(bytes_);
    std::memcpy(bytes_.data(), &header_, sizeof header_);
  }

  const HairMesh& mesh_;
  Header header_ = {};
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(const ByteSource& source) : source_(source) {
    header_ = source.get<Header>(0, "header");
    check_header();
    const std::vector<char> text = source.read_all();
    bytes_.assign(text.begin(), text.end());
    if (hair_mesh_checksum(bytes_) != header_.checksum) bad("header", "the checksum does not match");
    at_ = sizeof(Header);
  }

  HairMesh read() {
    HairMesh mesh;
    mesh.width = header_.width;
    read_layers(mesh);
    read_positions(mesh);
    if (has(header_, kTangents)) read_tangents(mesh);
    mesh.uvw.resize(header_.vertices);
    for (Vec3& p : mesh.uvw) p.x = take_share(kWideUvw), p.y = take_share(kWideUvw), p.z = take_share(kWideUvw);
    if (has(header_, kOcclusion)) {
      mesh.occlusion.resize(header_.vertices);
      for (float& x : mesh.occlusion) x = take_share(kWideOcclusion);
    }
    read_bundles(mesh);
    read_styles(mesh);
    mesh.comment = bytes_.substr(at_, header_.comment_bytes);
    at_ += header_.comment_bytes;
    if (at_ != bytes_.size()) bad(fmt::format("byte {}", at_), fmt::format("{} bytes too many", bytes_.size() - at_));
    return mesh;
  }

 private:
  void check_header() const {
    if (header_.major != kMajor)
      throw Error(source_.name(), "header",
                  fmt::format("format version {}.{}; this program reads {}.x", header_.major, header_.minor, kMajor),
                  "use a newer Pelage");
    if (header_.file_size != source_.size())
      bad("header", fmt::format("{} bytes announced, the file has {}", header_.file_size, source_.size()));
    if (header_.flags & ~kKnownFlags) bad("header", fmt::format("flags {:#x}", header_.flags));
    if (std::max({header_.columns, header_.vertices, header_.bundles}) > HairMesh::kMaxVertices)
      bad("header", fmt::format("{} columns, {} vertices, {} bundles; {} at most", header_.columns, header_.vertices,
                                header_.bundles, HairMesh::kMaxVertices));
    // Of the styles the least: their operators are counted one style after the other.
    const std::uint64_t least = sizeof(Header) + header_.columns + std::uint64_t{header_.vertices} * vertex_bytes() +
                                (has(header_, kFloatPlaces) ? 0u : sizeof(Bounds) + (has(header_, kTangents) ? 4u : 0u)) +
                                std::uint64_t{header_.bundles} * (column_bytes() * 4 + 12) + header_.styles +
                                header_.comment_bytes;
    source_.require(0, least, "columns, vertices, bundles, styles and comment");
  }
  std::uint64_t vertex_bytes() const {
    const std::uint64_t vector = has(header_, kFloatPlaces) ? 12 : 6;
    return vector * (has(header_, kTangents) ? 2 : 1) + (has(header_, kWideUvw) ? 6 : 3) +
           (has(header_, kOcclusion) ? (has(header_, kWideOcclusion) ? 2 : 1) : 0);
  }
  std::uint64_t column_bytes() const { return header_.columns <= 65536 ? 2 : 4; }

  template <class T>
  T take() {
    if (sizeof(T) > bytes_.size() - at_) bad(fmt::format("byte {}", at_), "the file ends here");
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  float take_share(Flag wide) { return has(header_, wide) ? share_of(take<std::uint16_t>()) : share_of(take<std::uint8_t>()); }

  void read_layers(HairMesh& mesh) {
    mesh.column_offsets.resize(header_.columns + std::size_t{1});
    for (std::size_t c = 0; c < header_.columns; ++c)
      mesh.column_offsets[c + 1] = mesh.column_offsets[c] + take<std::uint8_t>();
    if (mesh.column_offsets.back() != header_.vertices)
      bad("columns", fmt::format("they have {} vertices, the header says {}", mesh.column_offsets.back(), header_.vertices));
  }
  void read_positions(HairMesh& mesh) {
    mesh.positions.resize(header_.vertices);
    if (has(header_, kFloatPlaces)) return read_floats(mesh.positions);
    const auto lower = take<Vec3>(), upper = take<Vec3>();
    for (Vec3& p : mesh.positions) {
      p.x = place_in(lower.x, upper.x, take<std::uint16_t>());
      p.y = place_in(lower.y, upper.y, take<std::uint16_t>());
      p.z = place_in(lower.z, upper.z, take<std::uint16_t>());
    }
  }
  void read_tangents(HairMesh& mesh) {
    mesh.tangents.resize(header_.vertices);
    if (has(header_, kFloatPlaces)) return read_floats(mesh.tangents);
    const auto largest = take<float>();
    const auto component = [&] { return static_cast<float>(take<std::int16_t>()) / kTangentSteps * largest; };
    for (Vec3& t : mesh.tangents) t.x = component(), t.y = component(), t.z = component();
  }
  void read_floats(std::vector<Vec3>& vectors) {
    for (Vec3& v : vectors) v = take<Vec3>();
  }
  void read_bundles(HairMesh& mesh) {
    mesh.bundles.resize(header_.bundles);
    for (HairMesh::Bundle& b : mesh.bundles) {
      for (std::uint32_t& column : b.columns) column = column_bytes() == 2 ? take<std::uint16_t>() : take<std::uint32_t>();
      b.strands = take<std::uint32_t>(), b.style = take<std::uint32_t>(), b.seed = take<std::uint32_t>();
    }
  }
  void read_styles(HairMesh& mesh) {
    mesh.styles.resize(header_.styles);
    for (auto& style : mesh.styles) {
      style.resize(take<std::uint8_t>());
      for (StyleOperator& o : style) {
        const auto kind = take<std::uint8_t>();
        if (kind >= StyleOperator::kKinds) bad(fmt::format("byte {}", at_ - 1), fmt::format("operator {}", kind));
        o.kind = static_cast<StyleOperator::Kind>(kind);
        o.amount = take<float>(), o.frequency = take<float>(), o.start = take<float>(), o.variation = take<float>();
      }
    }
  }

  [[noreturn]] void bad(const std::string& place, const std::string& problem) const {
    throw Error(source_.name(), place, problem, "the file is damaged; write or copy it again");
  }

  const ByteSource& source_;
  Header header_ = {};
  std::string bytes_;
  std::size_t at_ = 0;
};

}  // namespace

std::uint64_t hair_mesh_checksum(std::string_view bytes) {
  Xxh64 hash;
  hash.add(bytes.data(), offsetof(Header, checksum));
  hash.add(bytes.data() + sizeof(Header), bytes.size() - sizeof(Header));
  return hash.value();
}

HairMesh read_hair_mesh_binary(const ByteSource& source) { return Reader(source).read(); }

void write_hair_mesh_binary(AtomicFile& file, const HairMesh& mesh, const HairMeshPrecision& precision) {
  file.write(Writer(mesh, precision).bytes());
}

}  // namespace pelage::io
