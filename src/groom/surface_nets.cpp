#include "groom/surface_nets.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pelage::groom {
namespace {

constexpr std::uint32_t kNoVertex = 0xffffffffu;

/// Mean of the places where the cell's twelve edges cross zero; false when none does.
bool cell_vertex(const DistanceGrid& grid, int x, int y, int z, Vec3* vertex) {
  Vec3 sum;
  int crossings = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int corner = 0; corner < 4; ++corner) {
      int a[3] = {x, y, z};
      a[(axis + 1) % 3] += corner & 1, a[(axis + 2) % 3] += corner >> 1;
      int b[3] = {a[0], a[1], a[2]};
      ++b[axis];
      const float da = grid.distance[grid.index(a[0], a[1], a[2])], db = grid.distance[grid.index(b[0], b[1], b[2])];
      if ((da < 0) == (db < 0)) continue;
      sum = sum + lerp(grid.place(a[0], a[1], a[2]), grid.place(b[0], b[1], b[2]), da / (da - db));
      ++crossings;
    }
  if (crossings == 0) return false;
  *vertex = sum / static_cast<float>(crossings);
  return true;
}

/// Two triangles over the shorter diagonal.
void add_quad(TriangleMesh& mesh, std::array<std::uint32_t, 4> v) {
  const auto diagonal = [&](int i, int j) {
    const Vec3 d = mesh.positions[v[static_cast<std::size_t>(i)]] - mesh.positions[v[static_cast<std::size_t>(j)]];
    return dot(d, d);
  };
  if (diagonal(0, 2) <= diagonal(1, 3)) {
    mesh.triangles.push_back({v[0], v[1], v[2]}), mesh.triangles.push_back({v[0], v[2], v[3]});
  } else {
    mesh.triangles.push_back({v[0], v[1], v[3]}), mesh.triangles.push_back({v[1], v[2], v[3]});
  }
}

}  // namespace

TriangleMesh surface_nets(const DistanceGrid& grid) {
  TriangleMesh mesh;
  std::vector<std::uint32_t> vertex_of_cell(grid.distance.size(), kNoVertex);
  for (int z = 0; z + 1 < grid.nz; ++z)
    for (int y = 0; y + 1 < grid.ny; ++y)
      for (int x = 0; x + 1 < grid.nx; ++x) {
        Vec3 p;
        if (!cell_vertex(grid, x, y, z, &p)) continue;
        vertex_of_cell[grid.index(x, y, z)] = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(p);
      }

  const int size[3] = {grid.nx, grid.ny, grid.nz};
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    int at[3];
    for (at[2] = 0; at[2] < size[2]; ++at[2])
      for (at[1] = 0; at[1] < size[1]; ++at[1])
        for (at[0] = 0; at[0] < size[0]; ++at[0]) {
          if (at[axis] + 1 >= size[axis] || at[u] == 0 || at[v] == 0 || at[u] + 1 >= size[u] || at[v] + 1 >= size[v]) continue;
          int next[3] = {at[0], at[1], at[2]};
          ++next[axis];
          const bool inside = grid.distance[grid.index(at[0], at[1], at[2])] < 0;
          if (inside == (grid.distance[grid.index(next[0], next[1], next[2])] < 0)) continue;
          // The four cells around the edge, counter-clockwise about +axis.
          const auto cell = [&](int du, int dv) {
            int c[3] = {at[0], at[1], at[2]};
            c[u] += du, c[v] += dv;
            return vertex_of_cell[grid.index(c[0], c[1], c[2])];
          };
          std::array<std::uint32_t, 4> quad{cell(-1, -1), cell(0, -1), cell(0, 0), cell(-1, 0)};
          if (!inside) std::swap(quad[1], quad[3]);
          add_quad(mesh, quad);
        }
  }
  return mesh;
}

}  // namespace pelage::groom
