// Hair meshes: a groom as a cage of a few kilobytes, from which strands are made when they are needed
// (Yuksel 2009, Bhokare 2024, Lipp 2026; references.bib). Subject of US patent 9,177,421: see THIRD_PARTY.md.
#pragma once

#include <pelage/progress.h>
#include <pelage/strand_set.h>
#include <pelage/vec.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pelage {

/// One step of how a strand leaves its smooth base, a function of its place (u, v, w) in the groom and of random numbers of
/// the strand. What the four numbers mean, and their ranges, stands with each kind; numbers that a kind does not name are 0.
/// `start` 0…1 is the w from which the operator sets in: its strength grows smoothly from 0 there to 1 a quarter of the strand
/// farther on; that of clump and taper at the tip.
struct StyleOperator {
  enum class Kind : std::uint8_t {
    kLength,  ///< amount 0.05…2: longest strand as a share of the cage, straight on beyond 1; variation 0…1: the shortest
              ///< is amount·(1 − variation)
    kClump,  ///< strands gather: amount 0…1 at the tip; frequency 1…32: clumps along each side of a bundle, a whole number; start;
             ///< variation 0…1: how much clumps differ
    kBraid,  ///< three locks over and under each other: amount 0…1, thickness of a lock as a share of the bundle;
             ///< frequency 0…64: crossings of one lock; start; variation 0…1: looseness
    kWave,  ///< swings to one side: amount 0…0.1 m; frequency 0…128: waves along the strand; start; variation 0…1: from all
            ///< strands of a bundle in step to each on its own
    kCurl,   ///< helix: amount 0…0.1 m, its radius; frequency 0…128: turns; start; variation 0…1 as with waves
    kNoise,  ///< smooth disorder, alike for neighbors: amount 0…0.1 m; frequency 0…64: waves across the groom; start;
             ///< variation 0…1: share that each strand has to itself
    kFrizz,  ///< every strand on its own: amount 0…0.1 m; frequency 0…128: waves along it; start; variation 0…1: share of
             ///< strands that have little of it
    kTaper,  ///< width: amount 0…1, the tip's as a share of the root's; start; variation 0…1: how much strands differ
  };
  static constexpr std::size_t kKinds = 8;
  Kind kind = Kind::kLength;
  float amount = 0, frequency = 0, start = 0, variation = 0;
};

/// Columns of vertices and the bundles of hair between them. Metres, Y up; vertex 0 of a column is at the root.
///
/// A bundle is a stack of quads, one per layer, between four columns of equal length. Strand (u, v) of it follows the
/// bilinear interpolation of the columns across, and a cubic Hermite spline along: w = 0 at the root layer … 1 at the last.
/// Neighboring bundles share columns, so that hair parts nowhere but where the columns are doubled.
struct HairMesh {
  struct Bundle {
    std::array<std::uint32_t, 4> columns{};  ///< at (u, v) = (0, 0), (1, 0), (1, 1), (0, 1)
    std::uint32_t strands = 0;               ///< N of Lipp 2026, eq. 1: at full detail, 1…kMaxStrands
    std::uint32_t style = 0;                 ///< its list of operators
    std::uint32_t seed = 0;                  ///< of its random numbers
  };
  static constexpr std::uint32_t kMaxStrands = 1u << 20;  ///< of a bundle
  static constexpr std::uint32_t kMaxLayers = 64;         ///< of a column; 2 at least
  static constexpr std::size_t kMaxVertices = 1u << 20;   ///< of the mesh; columns and bundles as many at most
  static constexpr std::size_t kMaxOperators = 8;         ///< of a style

  std::vector<std::uint32_t> column_offsets;  ///< [columns + 1] into the vertices; first 0, last vertex_count
  std::vector<Vec3> positions;                ///< [vertex_count] metres
  std::vector<Vec3>
      tangents;           ///< [0] or [vertex_count] dp/d(layer), metres; empty: central differences (one-sided at the ends)
  std::vector<Vec3> uvw;  ///< [vertex_count] 0…1: place in the groom, for noise and for maps of material
  std::vector<float>
      occlusion;  ///< [0] or [vertex_count] 0…1: share of the sky that the vertex sees through the hair; empty: 1
  std::vector<Bundle> bundles;
  std::vector<std::vector<StyleOperator>> styles;  ///< what Bundle::style numbers; each kind at most once in a list
  float width = 8e-5f;                             ///< diameter at the root, metres, 0…0.1
  std::string comment;                             ///< free text, UTF-8

  std::size_t vertex_count() const { return positions.size(); }
  std::size_t column_count() const { return column_offsets.empty() ? 0 : column_offsets.size() - 1; }
  std::uint32_t layers(const Bundle& b) const { return column_offsets[b.columns[0] + 1] - column_offsets[b.columns[0]]; }
};

/// Throws Error(`where`, …) naming the first broken rule of HairMesh and of the ranges of StyleOperator. O(mesh).
void validate(const HairMesh& mesh, const std::string& where);

/// Names in files and on the command line: "length", "clump", "braid", "wave", "curl", "noise", "frizz", "taper".
const std::vector<std::string>& style_operator_names();

/// Strands of all bundles at full detail.
std::uint64_t strand_count(const HairMesh& mesh);

/// Box of the strands at full detail: of the cage, and of what operators may add to it.
Bounds bounds(const HairMesh& mesh);
Bounds bounds(const HairMesh& mesh, const HairMesh::Bundle& bundle);

/// Most control points of a strand: C_max of Lipp 2026, eq. 4.
inline constexpr std::uint32_t kHairMeshPoints = 127;

struct ExpandSettings {
  std::uint32_t points = 64;  ///< control points per strand, 2…kHairMeshPoints (the layers of its bundle at least)
  float share = 1;  ///< of the strands of each bundle, 0…1, ⌈share·N⌉ of them: the first ones, whose order is random
};

/// The strands of `mesh`, as any other groom: what every renderer but method swr draws, and the truth for that one.
/// Linear basis; root_uv is the groom's (u, v), group the bundle's style, strand_id counts through the bundles at full detail.
/// The same bits for any thread count. Throws Error on settings out of range or where points pass 2³².
StrandSet expand(const HairMesh& mesh, const ExpandSettings& settings = {}, const Progress& progress = {});

/// Bytes held by the arrays.
std::size_t resident_bytes(const HairMesh& mesh);

}  // namespace pelage
