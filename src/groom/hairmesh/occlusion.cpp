// Ambient occlusion of a hair mesh's vertices: the groom as a cloud in a grid, and the mean of what comes through it.
#include <pelage/hair_mesh_styles.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "core/shared_progress.h"

namespace pelage {
namespace {

constexpr std::uint64_t kMostStrands = 40000;  // of the sample that stands for all
constexpr std::uint32_t kPoints = 48;          // of each
constexpr int kCells = 100;                    // along the longest side of the groom
constexpr int kDirections = 128;

/// Strands in a cell: the area that they turn to a ray along ω is about Σ d·ℓ·√(1 − ωᵀTω), T the mean of t·tᵀ weighted by d·ℓ.
/// Exact where all of them run one way; where they run every way it is 4 % too much (√(2/3) for π/4).
struct Cell {
  float area = 0;                     ///< Σ d·ℓ, per cubic metre
  std::array<float, 6> moments = {};  ///< Σ d·ℓ·t·tᵀ: xx, yy, zz, xy, xz, yz
};

class Cloud {
 public:
  explicit Cloud(const HairMesh& mesh) {
    ExpandSettings settings;
    settings.points = kPoints;
    settings.share =
        static_cast<float>(std::min(1., static_cast<double>(kMostStrands) / static_cast<double>(strand_count(mesh))));
    const StrandSet strands = expand(mesh, settings);
    Bounds box = bounds(strands);
    for (const Vec3 p : mesh.positions) box.extend(p);
    lower_ = box.lower;
    const Vec3 extent = box.extent();
    size_ = std::max({extent.x, extent.y, extent.z, 1e-6f}) / static_cast<float>(kCells);
    for (int axis = 0; axis < 3; ++axis) {
      const float side = axis == 0 ? extent.x : axis == 1 ? extent.y : extent.z;
      count_[static_cast<std::size_t>(axis)] = static_cast<int>(side / size_) + 1;
    }
    cells_.resize(static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) *
                  static_cast<std::size_t>(count_[2]));
    const float scale =
        static_cast<float>(static_cast<double>(strand_count(mesh)) / static_cast<double>(strands.strand_count()));
    for (std::size_t s = 0; s < strands.strand_count(); ++s) add_strand(strands, s, scale / (size_ * size_ * size_));
  }

  /// Share of light that comes from far away along −`way` to `from`.
  float transmittance(Vec3 from, Vec3 way) const {
    const float step = 0.5f * size_;
    float depth = 0;
    for (float t = 0.5f * step;; t += step) {
      const Cell* cell = at(from + way * t);
      if (!cell) break;
      if (cell->area > 0) depth += step * turned_to(*cell, way);
    }
    return std::exp(-depth);
  }

 private:
  /// Null outside, from where no ray comes back: the box holds vertices and strands.
  const Cell* at(Vec3 p) const {
    const Vec3 local = (p - lower_) / size_;
    const int x = static_cast<int>(std::floor(local.x)), y = static_cast<int>(std::floor(local.y)),
              z = static_cast<int>(std::floor(local.z));
    if (x < 0 || y < 0 || z < 0 || x >= count_[0] || y >= count_[1] || z >= count_[2]) return nullptr;
    return &cells_[index(x, y, z)];
  }
  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(count_[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(count_[0]) +
           static_cast<std::size_t>(x);
  }
  static float turned_to(const Cell& c, Vec3 w) {
    const std::array<float, 6>& m = c.moments;
    const float along =
        m[0] * w.x * w.x + m[1] * w.y * w.y + m[2] * w.z * w.z + 2 * (m[3] * w.x * w.y + m[4] * w.x * w.z + m[5] * w.y * w.z);
    return std::sqrt(std::max(c.area * (c.area - along), 0.f));
  }

  /// Pieces of half a cell at most, each into the cell of its middle. One strand after the other: sums of floats.
  void add_strand(const StrandSet& strands, std::size_t s, float scale) {
    for (std::size_t i = strands.offsets[s]; i + 1 < strands.offsets[s + 1]; ++i) {
      const Vec3 a = strands.points[i], d = strands.points[i + 1] - a;
      const float whole = length(d);
      if (!(whole > 0)) continue;
      const Vec3 t = d / whole;
      const int pieces = 1 + static_cast<int>(whole / (0.5f * size_));
      const float area = scale * whole / static_cast<float>(pieces) * 0.5f * (strands.width(i) + strands.width(i + 1));
      const float moments[6] = {t.x * t.x, t.y * t.y, t.z * t.z, t.x * t.y, t.x * t.z, t.y * t.z};
      for (int k = 0; k < pieces; ++k) {
        const Vec3 middle = a + d * ((static_cast<float>(k) + 0.5f) / static_cast<float>(pieces));
        Cell* const cell = const_cast<Cell*>(at(middle));
        if (!cell) continue;
        cell->area += area;
        for (std::size_t m = 0; m < 6; ++m) cell->moments[m] += area * moments[m];
      }
    }
  }

  Vec3 lower_;
  float size_ = 1;
  std::array<int, 3> count_{};
  std::vector<Cell> cells_;
};

/// Even over the sphere: a Fibonacci spiral.
Vec3 direction(int i) {
  constexpr float kGoldenAngle = 2.39996323f;
  const float z = 1 - (2 * static_cast<float>(i) + 1) / kDirections, r = std::sqrt(1 - z * z);
  return {r * std::cos(kGoldenAngle * static_cast<float>(i)), z, r * std::sin(kGoldenAngle * static_cast<float>(i))};
}

}  // namespace

void bake_occlusion(HairMesh& mesh, const Progress& progress) {
  validate(mesh, "hair mesh");
  const Cloud cloud(mesh);
  std::vector<float> occlusion(mesh.vertex_count());
  SharedProgress shared(progress, "occlusion", mesh.vertex_count());
  parallel_for(mesh.vertex_count(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      float sum = 0;
      for (int i = 0; i < kDirections; ++i) sum += cloud.transmittance(mesh.positions[v], direction(i));
      occlusion[v] = sum / kDirections;
    }
    shared.add(end - begin);
  });
  mesh.occlusion = std::move(occlusion);
}

}  // namespace pelage
