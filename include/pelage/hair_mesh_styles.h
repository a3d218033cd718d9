// Hair meshes made by code, ready to render: demo, benchmark and test data, and a start for one's own.
#pragma once

#include <pelage/hair_mesh.h>
#include <pelage/progress.h>

#include <cstdint>
#include <string>
#include <vector>

namespace pelage {

enum class HairMeshStyle { kBob, kWavy, kCurls, kAfro, kPonytail, kBraid };

/// What to make. make_hair_mesh() throws an Error that names the setting and its range when one is outside it.
struct HairMeshSettings {
  HairMeshStyle style = HairMeshStyle::kBob;
  std::uint32_t seed = 1;          ///< any; another seed is another head of hair in the same cut
  std::uint32_t strands = 127000;  ///< of all bundles, 1000…1,000,000; shared out by the area that they stand on
  float width = 8e-5f;             ///< diameter at the root, metres, 0…0.1
  float length = 1;                ///< of the hair, as a share of the style's own, 0.5…1.5
  float parting = 0.018f;          ///< metres left of the head's middle, −0.05…0.05; of styles that are parted
  bool occlusion = true;           ///< bake_occlusion() at the end
};

/// Names used on the command line: "bob", "long-wavy", "curls", "afro", "ponytail", "braid".
/// None in a build without hair meshes.
const std::vector<std::string>& hair_mesh_style_names();
HairMeshStyle hair_mesh_style_from_name(const std::string& name);  ///< throws Error naming the nearest style

/// A head of hair for mannequin_head(), on the scalp of which every column has its root: 10 to 20 KB as a file.
/// The same bits for any thread count.
HairMesh make_hair_mesh(const HairMeshSettings& settings = {}, const Progress& progress = {});

/// Whether `mesh` stands on the scalp of mannequin_head(), as make_hair_mesh() and a fit to hair grown there leave it. Quads of a
/// cage cut corners: roots count within 9 mm of the skin and 12 mm of the hairline, and one in twenty may lie elsewhere.
bool grown_on_mannequin(const HairMesh& mesh);

/// Fills `mesh.occlusion`: the share of light from all directions that reaches each vertex through the groom, taken as a cloud
/// of as much hair as the strands put there. The head and other meshes do not count. The same bits for any thread count.
///
/// Strands of a sample of at most 40,000 are expanded into a grid of cells about 4 mm wide; seconds at most.
void bake_occlusion(HairMesh& mesh, const Progress& progress = {});

}  // namespace pelage
