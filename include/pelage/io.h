// Files in and out. Content decides the format, never the extension; a file is written whole or not at all.
#pragma once

#include <pelage/hair_mesh.h>
#include <pelage/image.h>
#include <pelage/progress.h>
#include <pelage/scene.h>
#include <pelage/strand_set.h>
#include <pelage/triangle_mesh.h>

#include <string>
#include <vector>

namespace pelage {

enum class UpAxis { kAuto, kY, kZ };

struct ImportOptions {
  float scale = 0;            ///< metres per file unit; 0 guesses (see ImportReport)
  UpAxis up = UpAxis::kAuto;  ///< which file axis points up
  float default_width = 0;    ///< metres, for files without widths; 0 guesses: 80 µm, more for sparse grooms (0.8 mm at most)
};

/// What the reader assumed, and what it repaired: printed by `pelage info`.
struct ImportReport {
  std::string format;      ///< registered name, e.g. "cyhair"
  float scale = 1;         ///< metres per file unit that was applied
  UpAxis up = UpAxis::kY;  ///< that was applied
  bool scale_guessed = false, up_guessed = false, width_guessed = false;
  RepairReport repairs;
  std::vector<std::string> notes;  ///< one sentence each, for people
};

/// Reads any registered groom format, and hair meshes as the strands of expand(). Throws Error naming byte, line or strand. The result satisfies validate().
StrandSet read_strands(const std::string& path, const ImportOptions& options = {}, ImportReport* report = nullptr,
                       const Progress& progress = {});

/// Writes `strands` in the format of `format` (or, when empty, of the extension). Attributes that the format cannot hold
/// are named in the returned list, one sentence each. Throws Error; then nothing is left at `path` that was not there.
std::vector<std::string> write_strands(const std::string& path, const StrandSet& strands, const std::string& format = "",
                                       const Progress& progress = {});

struct FormatInfo {
  std::string name;                     ///< "cyhair"
  std::string description;              ///< one line
  std::vector<std::string> extensions;  ///< without dot
  bool reads = false, writes = false;
};
/// The registered groom formats.
std::vector<FormatInfo> strand_formats();

/// How exactly a binary hair mesh is written. The defaults err by 4 µm on a head of hair.
struct HairMeshPrecision {
  bool float_positions = false;  ///< positions and tangents as 32-bit floats; otherwise 16 bits within the box of the mesh
  bool wide_attributes = false;  ///< uvw and occlusion in 16 bits; otherwise in 8
};

/// Reads a hair mesh, binary or text. Throws Error naming byte, line or key. The result satisfies validate().
HairMesh read_hair_mesh(const std::string& path);

/// Writes `mesh`, as binary where `path` ends in `.hairmesh`, as text where in `.json` (lossless whatever `precision` says).
/// Throws Error, also where `mesh` does not satisfy validate(); then nothing is left at `path` that was not there.
void write_hair_mesh(const std::string& path, const HairMesh& mesh, const HairMeshPrecision& precision = {});

/// OBJ, PLY, binary glTF, TressFX .tfxmesh. `scale` metres per file unit. Throws Error.
TriangleMesh read_mesh(const std::string& path, float scale = 1, UpAxis up = UpAxis::kY);
void write_mesh(const std::string& path, const TriangleMesh& mesh);

/// EXR, PNG, Radiance HDR. 8-bit images are decoded from sRGB to linear when `linearize`. Throws Error.
Image read_image(const std::string& path, bool linearize = true);
/// EXR: half by default, float when `full_float`. PNG: 8 bits, values taken as display-encoded 0…1. HDR: RGBE. Throws Error.
void write_image(const std::string& path, const Image& image, bool full_float = false);

/// Scene file (JSON, schema in docs/scene.schema.json). Files named in it are found relative to it. Throws Error that
/// names the key, and for an unknown key the nearest known one.
Scene read_scene(const std::string& path, const Progress& progress = {});

}  // namespace pelage
