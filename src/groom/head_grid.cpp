#include "groom/head_grid.h"

#include <pelage/error.h>
#include <pelage/simulate.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "core/parallel.h"
#include "groom/mannequin.h"

namespace pelage {
namespace groom {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
constexpr std::uint32_t kNone = 0xffffffffu;
constexpr int kMargin = 3;  // cells around the mesh

/// The mesh with one vertex per place, and normals of its faces, edges and vertices.
class SignedMesh {
 public:
  explicit SignedMesh(const TriangleMesh& mesh) {
    weld(mesh);
    vertex_normals_.resize(places_.size());
    double volume = 0;
    for (const Triangle& t : triangles_) {
      const Vec3 a = places_[t[0]], b = places_[t[1]], c = places_[t[2]], normal = normalize(cross(b - a, c - a));
      face_normals_.push_back(normal);
      volume += static_cast<double>(dot(a, cross(b, c)));
      for (std::size_t i = 0; i < 3; ++i) {
        vertex_normals_[t[i]] += normal * angle(places_[t[i]], places_[t[(i + 1) % 3]], places_[t[(i + 2) % 3]]);
        edge_normals_[edge(t[i], t[(i + 1) % 3])] += normal;
      }
    }
    side_ = volume < 0 ? -1.f : 1.f;
  }

  std::size_t size() const { return triangles_.size(); }
  Bounds bounds(std::size_t i) const {
    Bounds box;
    for (const std::uint32_t v : triangles_[i]) box.extend(places_[v]);
    return box;
  }
  float distance2(std::size_t i, Vec3 p) const {
    const Vec3 off = p - nearest(i, p).point;
    return dot(off, off);
  }
  float signed_distance(std::size_t i, Vec3 p) const {
    const NearestOnTriangle n = nearest(i, p);
    const Vec3 off = p - n.point;
    return dot(off, normal_at(i, n.corners)) * side_ < 0 ? -length(off) : length(off);
  }

 private:
  static std::pair<std::uint32_t, std::uint32_t> edge(std::uint32_t a, std::uint32_t b) {
    return {std::min(a, b), std::max(a, b)};
  }
  static float angle(Vec3 at, Vec3 b, Vec3 c) {
    return std::acos(std::clamp(dot(normalize(b - at), normalize(c - at)), -1.f, 1.f));
  }

  void weld(const TriangleMesh& mesh) {
    std::map<std::tuple<float, float, float>, std::uint32_t> known;
    std::vector<std::uint32_t> vertex;
    for (const Vec3 p : mesh.positions) {
      const auto [found, fresh] = known.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(places_.size()));
      if (fresh) places_.push_back(p);
      vertex.push_back(found->second);
    }
    for (const Triangle& t : mesh.triangles) {
      const Triangle welded{vertex[t[0]], vertex[t[1]], vertex[t[2]]};
      const Vec3 a = places_[welded[0]], area = cross(places_[welded[1]] - a, places_[welded[2]] - a);
      if (dot(area, area) > 0) triangles_.push_back(welded);
    }
  }

  NearestOnTriangle nearest(std::size_t i, Vec3 p) const {
    const Triangle& t = triangles_[i];
    return nearest_on_triangle(p, places_[t[0]], places_[t[1]], places_[t[2]]);
  }
  Vec3 normal_at(std::size_t i, unsigned corners) const {
    const Triangle& t = triangles_[i];
    for (std::size_t c = 0; c < 3; ++c) {
      if (corners == 1u << c) return vertex_normals_[t[c]];
      if (corners == (7u & ~(1u << c))) return edge_normals_.at(edge(t[(c + 1) % 3], t[(c + 2) % 3]));
    }
    return face_normals_[i];
  }

  std::vector<Vec3> places_, face_normals_, vertex_normals_;
  std::vector<Triangle> triangles_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3> edge_normals_;
  float side_ = 1;
};

/// The triangle that is nearest to every corner of the grid, as it becomes known.
class NearestTriangles {
 public:
  NearestTriangles(const SignedMesh& mesh, DistanceGrid& grid)
      : mesh_(mesh), grid_(grid), nearest_(grid.distance.size(), kNone), square_(grid.distance.size(), INFINITY) {}

  /// Corners around each triangle, a cell beyond its box.
  void start() {
    for (std::uint32_t t = 0; t < mesh_.size(); ++t) {
      const Bounds box = mesh_.bounds(t);
      const std::array<int, 3> low = cell(box.lower), high = cell(box.upper);
      for (int z = std::max(0, low[2] - 1); z <= std::min(grid_.nz - 1, high[2] + 2); ++z)
        for (int y = std::max(0, low[1] - 1); y <= std::min(grid_.ny - 1, high[1] + 2); ++y)
          for (int x = std::max(0, low[0] - 1); x <= std::min(grid_.nx - 1, high[0] + 2); ++x) offer(x, y, z, t);
    }
  }

  /// One sweep through the grid, in directions dx, dy, dz ∈ {−1, 1}: what is nearest to a neighbor behind is likely nearest here.
  void sweep(int dx, int dy, int dz) {
    const auto run = [](int n, int d, const auto& visit) {
      for (int i = d > 0 ? 0 : n - 1; i >= 0 && i < n; i += d) visit(i);
    };
    run(grid_.nz, dz, [&](int z) {
      run(grid_.ny, dy, [&](int y) {
        run(grid_.nx, dx, [&](int x) {
          for (int n = 1; n < 8; ++n) {
            const int i = x - (n & 1 ? dx : 0), j = y - (n & 2 ? dy : 0), k = z - (n & 4 ? dz : 0);
            if (i < 0 || j < 0 || k < 0 || i >= grid_.nx || j >= grid_.ny || k >= grid_.nz) continue;
            if (const std::uint32_t t = nearest_[grid_.index(i, j, k)]; t != kNone) offer(x, y, z, t);
          }
        });
      });
    });
  }

  void finish() {
    parallel_for(static_cast<std::size_t>(grid_.nz), 1, [&](std::size_t begin, std::size_t end) {
      for (int z = static_cast<int>(begin); z < static_cast<int>(end); ++z)
        for (int y = 0; y < grid_.ny; ++y)
          for (int x = 0; x < grid_.nx; ++x) {
            const std::size_t i = grid_.index(x, y, z);
            grid_.distance[i] = mesh_.signed_distance(nearest_[i], grid_.place(x, y, z));
          }
    });
  }

 private:
  std::array<int, 3> cell(Vec3 p) const {
    const Vec3 c = (p - grid_.origin) / grid_.spacing;
    return {static_cast<int>(c.x), static_cast<int>(c.y), static_cast<int>(c.z)};
  }
  void offer(int x, int y, int z, std::uint32_t triangle) {
    const std::size_t i = grid_.index(x, y, z);
    if (nearest_[i] == triangle) return;
    const float d = mesh_.distance2(triangle, grid_.place(x, y, z));
    if (d < square_[i]) square_[i] = d, nearest_[i] = triangle;
  }

  const SignedMesh& mesh_;
  DistanceGrid& grid_;
  std::vector<std::uint32_t> nearest_;
  std::vector<float> square_;
};

DistanceGrid grid_around(const Bounds& box, int cells) {
  DistanceGrid grid;
  const Vec3 e = box.extent();
  grid.spacing = std::max({e.x, e.y, e.z}) / static_cast<float>(cells);
  const float margin = grid.spacing * kMargin;
  grid.origin = box.lower - Vec3(margin, margin, margin);
  const auto samples = [&](float side) { return static_cast<int>(std::ceil(side / grid.spacing)) + 2 * kMargin + 1; };
  grid.nx = samples(e.x), grid.ny = samples(e.y), grid.nz = samples(e.z);
  grid.distance.resize(grid.index(0, 0, grid.nz));
  return grid;
}

}  // namespace

// By the regions of the triangle that p projects to (Ericson 2004, section 5.1.5; references.bib: Ericson2004Collision).
NearestOnTriangle nearest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const float d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return {a, 1};
  if (d3 >= 0 && d4 <= d3) return {b, 2};
  if (d6 >= 0 && d5 <= d6) return {c, 4};
  const float vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + ab * (d1 / (d1 - d3)), 3};
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + ac * (d2 / (d2 - d6)), 5};
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return {b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), 6};
  const float scale = 1 / (va + vb + vc);
  return {a + ab * (vb * scale) + ac * (vc * scale), 7};
}

DistanceGrid mesh_distance(const TriangleMesh& mesh, int cells, const Progress& progress) {
  constexpr int kSweeps = 8;
  const SignedMesh surface(mesh);
  if (surface.size() == 0) throw Error("head", "mesh", "it has no triangles", "give a mesh with faces");
  DistanceGrid grid = grid_around(bounds(mesh), cells);
  NearestTriangles triangles(surface, grid);
  triangles.start();
  for (int pass = 0; pass < 2; ++pass)
    for (int s = 0; s < kSweeps; ++s) {
      if (progress && !progress("head shape", (pass * kSweeps + s) / (2. * kSweeps))) throw Error("head", "", "cancelled", "");
      triangles.sweep(s & 1 ? 1 : -1, s & 2 ? 1 : -1, s & 4 ? 1 : -1);
    }
  triangles.finish();
  return grid;
}

}  // namespace groom

std::shared_ptr<const HeadShape> make_head_shape(const TriangleMesh& mesh, int cells, const Progress& progress) {
  if (cells < 8 || cells > 512) throw Error("head", "cells", fmt::format("{} is out of range", cells), "8 … 512");
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t)
      if (v >= mesh.positions.size()) throw Error("head", "mesh", fmt::format("a triangle names vertex {}", v), "");
  auto shape = std::make_shared<HeadShape>();
  shape->grid = groom::is_mannequin(mesh) ? groom::mannequin().grid : groom::mesh_distance(mesh, cells, progress);
  return shape;
}

}  // namespace pelage
