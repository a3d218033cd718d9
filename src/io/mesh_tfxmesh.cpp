// TressFX collision mesh (.tfxmesh), text: numOfBones, numOfVertices (index, position, normal, joints and weights) and
// numOfTriangles (index, three vertices); '#' starts a comment. Bones are skipped: the bind pose is what is drawn.
#include <pelage/error.h>

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "io/mesh_formats.h"
#include "io/text_words.h"

namespace pelage::io {
namespace {

class TfxMeshReader {
 public:
  explicit TfxMeshReader(const ByteSource& source)
      : name_(source.name()), text_(source.read_all()), rest_(text_.data(), text_.size()) {}

  TriangleMesh read() {
    for (std::uint32_t bones = count("numOfBones"); bones > 0; --bones) line();
    TriangleMesh mesh;
    const std::uint32_t vertices = count("numOfVertices");
    for (std::uint32_t i = 0; i < vertices; ++i) {
      Words words = numbered(i);
      mesh.positions.push_back(vec3(words));
      mesh.normals.push_back(vec3(words));
    }
    const std::uint32_t triangles = count("numOfTriangles");
    for (std::uint32_t i = 0; i < triangles; ++i) {
      Words words = numbered(i);
      const std::uint32_t a = vertex(words, vertices), b = vertex(words, vertices);
      mesh.triangles.push_back({a, b, vertex(words, vertices)});
    }
    return mesh;
  }

 private:
  // The next line that says something.
  Words line() {
    while (!rest_.empty()) {
      ++line_number_;
      const std::string_view text = take_line(rest_);
      if (Words(text).next().empty() || text.starts_with('#')) continue;
      return Words(text);
    }
    fail("the file ends early");
  }

  // The value of the line `key value`. It announces that many lines of at least two bytes, which must be there.
  std::uint32_t count(std::string_view key) {
    Words words = line();
    const std::string_view found = words.next();
    if (found != key) fail(fmt::format("'{}' where {} is due", found, key));
    const auto value = integer_from<std::uint32_t>(words.next());
    if (!value) fail(fmt::format("{} without a number", key));
    if (*value > rest_.size() / 2) fail(fmt::format("{} {}, more than the rest of the file can hold", key, *value));
    return *value;
  }

  Words numbered(std::uint32_t i) {
    Words words = line();
    const auto value = integer_from<std::uint32_t>(words.next());
    if (!value || *value != i) fail(fmt::format("row {} is due", i));
    return words;
  }

  Vec3 vec3(Words& words) const {
    float v[3];
    for (float& x : v) {
      const std::string_view word = words.next();
      const std::optional<float> value = float_from(word);
      if (!value) fail(fmt::format("'{}' is no number", word));
      x = *value;
    }
    return {v[0], v[1], v[2]};
  }

  std::uint32_t vertex(Words& words, std::uint32_t vertices) const {
    const std::string_view word = words.next();
    const auto value = integer_from<std::uint32_t>(word);
    if (!value || *value >= vertices) fail(fmt::format("'{}' is none of the {} vertices", word, vertices));
    return *value;
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw Error(name_, fmt::format("line {}", line_number_), problem, "the file is damaged; export it again");
  }

  const std::string& name_;
  std::vector<char> text_;
  std::string_view rest_;
  std::size_t line_number_ = 0;
};

}  // namespace

bool looks_like_tfxmesh(std::string_view head) {
  while (!head.empty()) {
    const std::string_view line = take_line(head);
    if (line.empty() || line.starts_with('#')) continue;
    return Words(line).next() == "numOfBones";
  }
  return false;
}

TriangleMesh read_tfxmesh(const ByteSource& source) { return TfxMeshReader(source).read(); }

}  // namespace pelage::io
