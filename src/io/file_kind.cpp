#include "io/file_kind.h"

#include <algorithm>
#include <string_view>

#include "io/hair_mesh_formats.h"
#include "io/mesh_formats.h"
#include "io/strand_registry.h"

namespace pelage::io {
namespace {

constexpr std::pair<std::string_view, const char*> kImages[] = {
    {"\x76\x2f\x31\x01", "exr"}, {"\x89PNG\r\n", "png"}, {"#?RADIANCE", "hdr"}, {"#?RGBE", "hdr"}, {"\xff\xd8\xff", "jpeg"}};

// A line that begins with "f " somewhere in the first megabytes.
bool has_faces(const ByteSource& source) {
  constexpr std::uint64_t kLooked = 64 << 20;
  std::string text(std::min(source.size(), kLooked), '\0');
  source.read(0, text.size(), text.data(), "text");
  return text.find('\0') == std::string::npos && (text.starts_with("f ") || text.find("\nf ") != std::string::npos);
}

}  // namespace

std::string image_format(const ByteSource& source) {
  std::string head(std::min<std::uint64_t>(source.size(), 16), '\0');
  source.read(0, head.size(), head.data(), "magic");
  for (const auto& [magic, name] : kImages)
    if (head.starts_with(magic)) return name;
  return "";
}

FileKind file_kind(const ByteSource& source) {
  if (const std::string image = image_format(source); !image.empty()) return {FileContent::kImage, image};
  if (const HairMeshFile file = hair_mesh_file(source); file != HairMeshFile::kNone)
    return {FileContent::kHairMesh, file == HairMeshFile::kBinary ? "binary" : "text"};
  for (const StrandFormat* format : strand_registry())
    if (format->mismatch(source).empty()) return {};
  const std::string mesh = detect_mesh_format(source);
  if (mesh != "obj" || has_faces(source)) return {FileContent::kMesh, mesh};
  return {};
}

}  // namespace pelage::io
