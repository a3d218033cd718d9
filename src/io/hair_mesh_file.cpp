// Whether a file is a hair mesh: known in every build, so that one without hair meshes can say what it lacks.
#include <pelage/error.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "io/hair_mesh_formats.h"

namespace pelage::io {

HairMeshFile hair_mesh_file(const ByteSource& source) {
  constexpr std::string_view kMagic = "\x89HMESH\r\n", kKey = "\"hair_mesh\"", kBlank = " \t\r\n";
  std::array<char, 256> head = {};
  const std::size_t n = std::min<std::size_t>(source.size(), head.size());
  source.read(0, n, head.data(), "magic");
  std::string_view text(head.data(), n);
  if (n >= 4 && text.substr(0, kMagic.size()) == kMagic.substr(0, n)) return HairMeshFile::kBinary;
  const auto skip_blanks = [&] { text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size())); };
  skip_blanks();
  if (!text.starts_with('{')) return HairMeshFile::kNone;
  text.remove_prefix(1);
  skip_blanks();
  return text.starts_with(kKey) ? HairMeshFile::kText : HairMeshFile::kNone;
}

#if !PELAGE_HAIRMESH
std::string hair_mesh_schema() {
  throw Error("hair mesh", "", "this build of Pelage has no hair meshes", "build it with -D PELAGE_HAIRMESH=ON");
}
#endif

}  // namespace pelage::io
