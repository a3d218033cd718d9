// In place of the whole sub-module where a build leaves it out: every entry point says how to have it.
#include <pelage/error.h>
#include <pelage/hair_mesh_fit.h>
#include <pelage/hair_mesh_styles.h>
#include <pelage/io.h>

namespace pelage {
namespace {

[[noreturn]] void left_out(const std::string& where) {
  throw Error(where, "", "this build of Pelage has no hair meshes", "build it with -D PELAGE_HAIRMESH=ON");
}

}  // namespace

void validate(const HairMesh&, const std::string& where) { left_out(where); }
const std::vector<std::string>& style_operator_names() { left_out("hair mesh"); }
std::uint64_t strand_count(const HairMesh&) { left_out("hair mesh"); }
Bounds bounds(const HairMesh&) { left_out("hair mesh"); }
Bounds bounds(const HairMesh&, const HairMesh::Bundle&) { left_out("hair mesh"); }
StrandSet expand(const HairMesh&, const ExpandSettings&, const Progress&) { left_out("hair mesh"); }
HairMesh read_hair_mesh(const std::string& path) { left_out(path); }
void write_hair_mesh(const std::string& path, const HairMesh&, const HairMeshPrecision&) { left_out(path); }
// None: the words of a build without hair meshes do not name them.
const std::vector<std::string>& hair_mesh_style_names() {
  static const std::vector<std::string> names;
  return names;
}
HairMeshStyle hair_mesh_style_from_name(const std::string&) { left_out("hair mesh"); }
HairMesh make_hair_mesh(const HairMeshSettings&, const Progress&) { left_out("hair mesh"); }
bool grown_on_mannequin(const HairMesh&) { left_out("hair mesh"); }
void bake_occlusion(HairMesh&, const Progress&) { left_out("hair mesh"); }
HairMesh fit_hair_mesh(const StrandSet&, const HairMeshFitSettings&, HairMeshFitReport*, const Progress&) {
  left_out("hair mesh");
}
std::size_t resident_bytes(const HairMesh&) { left_out("hair mesh"); }

}  // namespace pelage
