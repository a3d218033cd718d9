#include "groom/roots.h"

#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rng.h"
#include "groom/point_grid.h"

namespace pelage::groom {
namespace {

constexpr std::uint32_t kDartStream = 0x726f6f74u;  // keeps darts apart from the strands' random numbers
constexpr int kPatience = 100;                      // darts that may miss in a row before all later discs shrink
constexpr float kThinnest = 0.1f;                   // density below which discs grow no further
constexpr float kLargestRadius = 8;                 // in spacings; bounds the cells that the first darts look at

void check_mesh(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw Error("surface", "", "the mesh has no triangles", "give a mesh with faces");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v >= mesh.positions.size())
        throw Error("surface", fmt::format("triangle {}", t), fmt::format("vertex {} of {}", v, mesh.positions.size()),
                    "repair the mesh");
      if (!is_finite(mesh.positions[v]))
        throw Error("surface", fmt::format("vertex {}", v), "a coordinate is not finite", "repair the mesh");
    }
}

/// Picks places by area and density. Vertex densities decide how often a triangle is drawn at all, so that a small
/// scalp on a large body costs no more darts than a bare scalp.
class SurfaceSampler {
 public:
  SurfaceSampler(const TriangleMesh& mesh, const DensityField& density) : mesh_(mesh), density_(density) {
    cumulative_.reserve(mesh.triangles.size());
    for (const auto& t : mesh.triangles) {
      const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
      double area = 0.5 * static_cast<double>(length(cross(b - a, c - a)));
      const float center = density ? density((a + b + c) / 3.f) : 1;
      if (density && std::max({density(a), density(b), density(c), center}) <= 0) area = 0;
      area_ += area * static_cast<double>(center);
      cumulative_.push_back((cumulative_.empty() ? 0 : cumulative_.back()) + area);
    }
    if (!(area_ > 0) || !std::isfinite(cumulative_.back()))
      throw Error("surface", "", "the mesh has no area to grow on", "give a mesh with faces that are not degenerate");
  }

  double area() const { return area_; }

  /// A place and the density there; 0 where the density rejected it.
  float draw(Rng& rng, Root* root) const {
    const double target = static_cast<double>(rng.uniform()) + static_cast<double>(rng.uniform()) * 0x1p-24;
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), target * cumulative_.back());
    const std::size_t t = std::min<std::size_t>(static_cast<std::size_t>(found - cumulative_.begin()), cumulative_.size() - 1);
    const float root_u = std::sqrt(rng.uniform()), v = rng.uniform();
    const float w[3] = {1 - root_u, root_u * (1 - v), root_u * v};
    const auto& triangle = mesh_.triangles[t];
    Vec3 p, n;
    Vec2 uv;
    for (std::size_t i = 0; i < 3; ++i) {
      p = p + mesh_.positions[triangle[i]] * w[i];
      if (!mesh_.normals.empty()) n = n + mesh_.normals[triangle[i]] * w[i];
      if (!mesh_.uv.empty()) uv = uv + mesh_.uv[triangle[i]] * w[i];
    }
    const float density = density_ ? density_(p) : 1;
    if (rng.uniform() >= density) return 0;
    if (!(dot(n, n) > 1e-12f) || !is_finite(n))
      n = cross(mesh_.positions[triangle[1]] - mesh_.positions[triangle[0]],
                mesh_.positions[triangle[2]] - mesh_.positions[triangle[0]]);
    *root = {p, normalize(n), uv};
    return density;
  }

 private:
  const TriangleMesh& mesh_;
  const DensityField& density_;
  std::vector<double> cumulative_;
  double area_ = 0;
};

}  // namespace

std::vector<Root> scatter_roots(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed, const DensityField& density) {
  check_mesh(mesh);
  const SurfaceSampler sampler(mesh, density);
  // n discs of radius f·spacing/√(n/count) cover π·f² of the surface: 1.3 leaves about a quarter of the darts a place.
  float packing = 0.65f;
  const float spacing = static_cast<float>(std::sqrt(sampler.area() / static_cast<double>(count)));
  PointGrid taken(std::max(spacing, 1e-7f), count);
  std::vector<Root> roots;
  roots.reserve(count);
  int misses = 0;
  for (std::uint32_t dart = 0; roots.size() < count; ++dart) {
    if (++misses > kPatience) packing *= 0.9f, misses = 0;
    const float fill = static_cast<float>(roots.size() + 1) / static_cast<float>(count);
    const float radius = spacing * std::min(packing / std::sqrt(fill), kLargestRadius);
    Rng rng(seed, kDartStream, dart * 8u);
    Root root;
    const float here = sampler.draw(rng, &root);
    if (here <= 0 || taken.any_within(root.position, radius / std::sqrt(std::max(here, kThinnest)))) continue;
    taken.insert(root.position);
    roots.push_back(root);
    misses = 0;
  }
  return roots;
}

float typical_spacing(const std::vector<Root>& roots, std::size_t count) {
  Bounds box;
  for (const Root& root : roots) box.extend(root.position);
  return std::max(length(box.extent()) / std::sqrt(static_cast<float>(count) + 1), 1e-6f);
}

}  // namespace pelage::groom
