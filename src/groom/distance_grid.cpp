#include "groom/distance_grid.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace pelage::groom {

DistanceGrid bake_distance(float (*field)(Vec3), Vec3 lower, Vec3 upper, float spacing) {
  DistanceGrid grid;
  grid.origin = lower, grid.spacing = spacing;
  const Vec3 cells = (upper - lower) / spacing;
  grid.nx = static_cast<int>(std::ceil(cells.x)) + 1;
  grid.ny = static_cast<int>(std::ceil(cells.y)) + 1;
  grid.nz = static_cast<int>(std::ceil(cells.z)) + 1;
  grid.distance.resize(grid.index(0, 0, grid.nz));
  parallel_for(static_cast<std::size_t>(grid.nz), 1, [&](std::size_t begin, std::size_t end) {
    for (int z = static_cast<int>(begin); z < static_cast<int>(end); ++z)
      for (int y = 0; y < grid.ny; ++y)
        for (int x = 0; x < grid.nx; ++x) grid.distance[grid.index(x, y, z)] = field(grid.place(x, y, z));
  });
  return grid;
}

DistanceSample sample_distance(const DistanceGrid& grid, Vec3 p) {
  const Vec3 local = (p - grid.origin) / grid.spacing;
  const Vec3 last(static_cast<float>(grid.nx - 1), static_cast<float>(grid.ny - 1), static_cast<float>(grid.nz - 1));
  const Vec3 inside = min(max(local, Vec3(0, 0, 0)), last);
  const int x = std::min(static_cast<int>(inside.x), grid.nx - 2);
  const int y = std::min(static_cast<int>(inside.y), grid.ny - 2);
  const int z = std::min(static_cast<int>(inside.z), grid.nz - 2);
  const float fx = inside.x - static_cast<float>(x), fy = inside.y - static_cast<float>(y),
              fz = inside.z - static_cast<float>(z);

  const float* c = grid.distance.data() + grid.index(x, y, z);
  const std::ptrdiff_t sy = grid.nx, sz = static_cast<std::ptrdiff_t>(grid.nx) * grid.ny;
  const auto mix = [](float a, float b, float t) { return a + (b - a) * t; };
  const float x00 = mix(c[0], c[1], fx), x10 = mix(c[sy], c[sy + 1], fx);
  const float x01 = mix(c[sz], c[sz + 1], fx), x11 = mix(c[sz + sy], c[sz + sy + 1], fx);
  const float y0 = mix(x00, x10, fy), y1 = mix(x01, x11, fy);
  const float dx0 = mix(c[1] - c[0], c[sy + 1] - c[sy], fy), dx1 = mix(c[sz + 1] - c[sz], c[sz + sy + 1] - c[sz + sy], fy);
  const float scale = 1 / grid.spacing;
  return {mix(y0, y1, fz) + length(local - inside) * grid.spacing,
          {mix(dx0, dx1, fz) * scale, mix(x10 - x00, x11 - x01, fz) * scale, (y1 - y0) * scale}};
}

}  // namespace pelage::groom
