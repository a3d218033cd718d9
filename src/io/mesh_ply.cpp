// Stanford PLY: ascii, binary little- and big-endian; any elements and properties, of which vertices and faces count.
#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>
#include <string_view>

#include "io/mesh_formats.h"

namespace pelage::io {
namespace {

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };
constexpr std::size_t kTypeBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};

std::optional<Type> type_of(std::string_view word) {
  constexpr std::pair<std::string_view, Type> kNames[] = {
      {"char", Type::kInt8},   {"int8", Type::kInt8},     {"uchar", Type::kUint8},   {"uint8", Type::kUint8},
      {"short", Type::kInt16}, {"int16", Type::kInt16},   {"ushort", Type::kUint16}, {"uint16", Type::kUint16},
      {"int", Type::kInt32},   {"int32", Type::kInt32},   {"uint", Type::kUint32},   {"uint32", Type::kUint32},
      {"float", Type::kFloat}, {"float32", Type::kFloat}, {"double", Type::kDouble}, {"float64", Type::kDouble}};
  for (const auto& [name, type] : kNames)
    if (name == word) return type;
  return std::nullopt;
}

enum class Role { kOther, kX, kY, kZ, kNx, kNy, kNz, kU, kV, kIndices };

Role role_of(std::string_view name) {
  // clang-format off
  constexpr std::pair<std::string_view, Role> kNames[] = {
      {"x", Role::kX}, {"y", Role::kY}, {"z", Role::kZ}, {"nx", Role::kNx}, {"ny", Role::kNy}, {"nz", Role::kNz},
      {"u", Role::kU}, {"v", Role::kV}, {"s", Role::kU}, {"t", Role::kV}, {"texture_u", Role::kU},
      {"texture_v", Role::kV}, {"vertex_indices", Role::kIndices}, {"vertex_index", Role::kIndices}};
  // clang-format on
  for (const auto& [known, role] : kNames)
    if (known == name) return role;
  return Role::kOther;
}

struct Property {
  Role role = Role::kOther;
  Type type = Type::kFloat;
  std::optional<Type> list_count;  // present: a list, its length of this type
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
  bool has(Role role) const {
    return std::any_of(properties.begin(), properties.end(), [&](const Property& p) { return p.role == role; });
  }
};

class PlyReader {
 public:
  explicit PlyReader(const ByteSource& source) : name_(source.name()), bytes_(source.read_all()) {}

  TriangleMesh read() {
    read_header();
    for (const Element& element : elements_) {
      if (element.name == "vertex") read_vertices(element);
      else if (element.name == "face") read_faces(element);
      else skip(element);
    }
    return std::move(mesh_);
  }

 private:
  void read_header() {
    for (std::string_view line = next_line(); line != "end_header"; line = next_line()) {
      std::vector<std::string_view> words;
      for (std::string_view word = split(line); !word.empty(); word = split(line)) words.push_back(word);
      if (words.empty()) continue;
      if (words[0] == "format" && words.size() >= 2) read_format(words[1]);
      else if (words[0] == "element" && words.size() == 3) elements_.push_back({std::string(words[1]), count(words[2]), {}});
      else if (words[0] == "property") read_property(words);
    }
    if (!formatted_) fail("no format line");
  }

  void read_format(std::string_view word) {
    ascii_ = word == "ascii";
    big_endian_ = word == "binary_big_endian";
    if (!ascii_ && !big_endian_ && word != "binary_little_endian") fail(fmt::format("unknown format '{}'", word));
    formatted_ = true;
  }

  void read_property(const std::vector<std::string_view>& words) {
    if (elements_.empty()) fail("a property before the first element");
    const bool list = words.size() == 5 && words[1] == "list";
    if (!list && words.size() != 3) fail("a property line that is neither 'TYPE NAME' nor 'list TYPE TYPE NAME'");
    const std::optional<Type> type = type_of(words[list ? 3 : 1]);
    const std::optional<Type> length = list ? type_of(words[2]) : std::nullopt;
    if (!type || (list && !length)) fail("an unknown property type");
    elements_.back().properties.push_back({role_of(words.back()), *type, length});
  }

  std::uint64_t count(std::string_view word) const {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) fail(fmt::format("'{}' is no count", word));
    return value;
  }

  // Every item takes at least this much, so a count that the rest of the file cannot hold is refused at once.
  void check_count(const Element& element) const {
    std::uint64_t least = 0;
    for (const Property& p : element.properties)
      least += ascii_ ? 2 : kTypeBytes[static_cast<int>(p.list_count.value_or(p.type))];
    const std::uint64_t left = bytes_.size() - at_ + (ascii_ ? 1 : 0);
    if (least > 0 && element.count > left / least)
      fail(fmt::format("{} of element '{}' announced, {} bytes are left", element.count, element.name, bytes_.size() - at_));
  }

  void read_vertices(const Element& element) {
    if (!element.has(Role::kX) || !element.has(Role::kY) || !element.has(Role::kZ)) fail("vertices without x, y and z");
    if (!mesh_.positions.empty()) fail("a second element 'vertex'");
    check_count(element);
    const bool uv = element.has(Role::kU) && element.has(Role::kV), normals = element.has(Role::kNx);
    mesh_.positions.resize(element.count);
    if (normals) mesh_.normals.resize(element.count);
    if (uv) mesh_.uv.resize(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      float values[static_cast<int>(Role::kIndices) + 1] = {};
      for (const Property& p : element.properties) {
        if (p.list_count) skip_list(p);
        else values[static_cast<int>(p.role)] = static_cast<float>(number(p.type));
      }
      const auto value = [&](Role role) { return values[static_cast<int>(role)]; };
      mesh_.positions[i] = {value(Role::kX), value(Role::kY), value(Role::kZ)};
      if (normals) mesh_.normals[i] = {value(Role::kNx), value(Role::kNy), value(Role::kNz)};
      if (uv) mesh_.uv[i] = {value(Role::kU), value(Role::kV)};
    }
  }

  void read_faces(const Element& element) {
    check_count(element);
    for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i)
      for (const Property& p : element.properties) {
        if (!p.list_count) number(p.type);
        else if (p.role == Role::kIndices) read_polygon(p);
        else skip_list(p);
      }
  }

  void read_polygon(const Property& p) {
    const std::uint64_t corners = list_length(p);
    std::uint32_t first = 0, previous = 0;
    for (std::uint64_t c = 0; c < corners; ++c) {
      const double value = number(p.type);
      if (!(value >= 0 && value < 4294967296.)) fail(fmt::format("vertex index {}", value));
      const auto index = static_cast<std::uint32_t>(value);
      if (c == 0) first = index;
      if (c >= 2) mesh_.triangles.push_back({first, previous, index});
      previous = index;
    }
  }

  void skip(const Element& element) {
    check_count(element);
    for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i)
      for (const Property& p : element.properties) {
        if (p.list_count) skip_list(p);
        else number(p.type);
      }
  }

  void skip_list(const Property& p) {
    for (std::uint64_t n = list_length(p); n > 0; --n) number(p.type);
  }

  std::uint64_t list_length(const Property& p) {
    const double length = number(*p.list_count);
    if (!(length >= 0 && length <= static_cast<double>(bytes_.size() - at_))) fail(fmt::format("a list of {} entries", length));
    return static_cast<std::uint64_t>(length);
  }

  double number(Type type) { return ascii_ ? ascii_number() : binary_number(type); }

  double ascii_number() {
    while (at_ < bytes_.size() && static_cast<unsigned char>(bytes_[at_]) <= ' ') ++at_;
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && static_cast<unsigned char>(bytes_[at_]) > ' ') ++at_;
    double value = 0;
    const auto [end, error] = std::from_chars(bytes_.data() + begin, bytes_.data() + at_, value);
    if (error == std::errc::result_out_of_range && end == bytes_.data() + at_) return 0;
    if (begin == at_) fail("the file ends in the middle of the data");
    if (error != std::errc() || end != bytes_.data() + at_)
      fail(fmt::format("'{}' is no number", std::string_view(bytes_.data() + begin, std::min<std::size_t>(at_ - begin, 40))));
    return value;
  }

  double binary_number(Type type) {
    switch (type) {
      case Type::kInt8: return take<std::int8_t>();
      case Type::kUint8: return take<std::uint8_t>();
      case Type::kInt16: return take<std::int16_t>();
      case Type::kUint16: return take<std::uint16_t>();
      case Type::kInt32: return take<std::int32_t>();
      case Type::kUint32: return take<std::uint32_t>();
      case Type::kFloat: return take<float>();
      case Type::kDouble: return take<double>();
    }
    return 0;
  }

  template <class T>
  double take() {
    if (bytes_.size() - at_ < sizeof(T)) fail("the file ends in the middle of the data");
    char raw[sizeof(T)];
    std::memcpy(raw, bytes_.data() + at_, sizeof(T));
    if (big_endian_) std::reverse(raw, raw + sizeof(T));
    at_ += sizeof(T);
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return static_cast<double>(value);
  }

  std::string_view next_line() {
    if (at_ >= bytes_.size()) fail("the header does not end with end_header");
    const char* const begin = bytes_.data() + at_;
    const auto* end = static_cast<const char*>(std::memchr(begin, '\n', bytes_.size() - at_));
    if (!end) fail("the header does not end with end_header");
    at_ += static_cast<std::size_t>(end - begin) + 1;
    std::string_view line(begin, static_cast<std::size_t>(end - begin));
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

  static std::string_view split(std::string_view& line) {
    const std::size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
    const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
    const std::string_view word = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return word;
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw Error(name_, fmt::format("byte {}", at_), problem, "the file is damaged; export it again");
  }

  const std::string& name_;
  std::vector<char> bytes_;
  std::size_t at_ = 0;
  bool formatted_ = false, ascii_ = false, big_endian_ = false;
  std::vector<Element> elements_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh read_ply(const ByteSource& source) { return PlyReader(source).read(); }

}  // namespace pelage::io
