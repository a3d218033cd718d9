// The public entry points for hair meshes: which of the two files it is, and that what leaves here is sound.
#include <pelage/error.h>
#include <pelage/io.h>

#include <algorithm>
#include <string_view>

#include "io/hair_mesh_formats.h"

namespace pelage {
namespace io {

HairMesh read_hair_mesh(const ByteSource& source) {
  if (source.size() == 0) throw Error(source.name(), "", "an empty file", "write the hair mesh again");
  const HairMeshFile file = hair_mesh_file(source);
  if (file == HairMeshFile::kNone)
    throw Error(source.name(), "", "not a hair mesh",
                "a binary one begins with \\x89HMESH, a text one is a JSON object whose first key is `hair_mesh`");
  HairMesh mesh = file == HairMeshFile::kBinary ? read_hair_mesh_binary(source) : read_hair_mesh_text(source);
  validate(mesh, source.name());
  return mesh;
}

}  // namespace io

namespace {

bool ends_with(std::string_view path, std::string_view extension) {
  const auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
  return path.size() > extension.size() &&
         std::equal(extension.begin(), extension.end(), path.end() - static_cast<std::ptrdiff_t>(extension.size()),
                    [&](char b, char a) { return same(a, b); });
}

}  // namespace

HairMesh read_hair_mesh(const std::string& path) { return io::read_hair_mesh(io::ByteSource::open(path)); }

void write_hair_mesh(const std::string& path, const HairMesh& mesh, const HairMeshPrecision& precision) {
  const bool text = ends_with(path, ".json");
  if (!text && !ends_with(path, ".hairmesh"))
    throw Error(path, "", "the extension names no file of hair meshes", "known: .hairmesh, .json");
  validate(mesh, path);
  io::AtomicFile file(path);
  if (text) io::write_hair_mesh_text(file, mesh);
  else io::write_hair_mesh_binary(file, mesh, precision);
  file.commit();
}

}  // namespace pelage
