#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "frame/camera_view.h"
#include "raster/analytic.h"
#include "raster/gbuffer.h"

namespace pelage {
namespace {

/// Box of a groom in the image, its widths included, pixels; empty where part of it may lie before the near plane.
Bounds image_box(const GroomInstance& groom, const CameraView& view) {
  const Bounds box = bounds(*groom.strands);
  if (box.empty()) return {};
  const Affine to_camera = compose(view.world_to_camera, groom.transform);
  Bounds seen;
  float nearest = INFINITY;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p(corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                 corner & 4 ? box.upper.z : box.lower.z);
    const Vec3 c = transform_point(to_camera, p);
    if (!(c.z > view.near_plane)) return {};
    const Vec2 at = project(view, c);
    seen.extend({at.x, at.y, 0});
    nearest = std::min(nearest, c.z);
  }
  const auto& widths = groom.strands->widths;
  const float widest = widths.empty() ? 0.f : *std::max_element(widths.begin(), widths.end());
  const float reach = widest * groom.width_scale * similarity_scale(groom.transform) * pixels_per_metre(view, nearest);
  seen.extend(seen.lower - Vec3(reach, reach, 0));
  seen.extend(seen.upper + Vec3(reach, reach, 0));
  return seen;
}

}  // namespace

AnalyticCells choose_cells(const Scene& scene, const CameraView& view) {
  Bounds all;
  float smallest = kCellsAcross;
  for (const GroomInstance& groom : scene.grooms) {
    if (groom.strands->strand_count() == 0) continue;
    const Bounds box = image_box(groom, view);
    if (box.empty()) return {};
    smallest = std::min(smallest, box.extent().y);
    all.extend(box);
  }
  AnalyticCells cells;
  if (all.empty()) return cells;
  const auto inside = [](float at, int size) { return static_cast<int>(std::clamp(at, 0.f, static_cast<float>(size))); };
  const int left = inside(all.lower.x, view.width), right = inside(all.upper.x + 1, view.width);
  const int top = inside(all.lower.y, view.height), bottom = inside(all.upper.y + 1, view.height);
  if (right <= left || bottom <= top) return cells;
  const double pixels = static_cast<double>(right - left) * (bottom - top);
  const float wanted = std::min(std::ceil(kCellsAcross / std::max(smallest, 1.f)), static_cast<float>(kMostCellsPerPixel));
  const int k = static_cast<int>(std::min(static_cast<double>(wanted), std::floor(std::sqrt(kMostCells / pixels))));
  if (k <= 1) return cells;
  cells.per_pixel = k, cells.left = left, cells.top = top;
  cells.view = view;
  const float scale = static_cast<float>(k);
  cells.view.focal *= scale;
  cells.view.center_x = (view.center_x - static_cast<float>(left)) * scale;
  cells.view.center_y = (view.center_y - static_cast<float>(top)) * scale;
  cells.view.width = (right - left) * k, cells.view.height = (bottom - top) * k;
  return cells;
}

namespace {

/// Calls visit(cell, pixel) for every cell of the pixels of image row `row` (counted from the first row with cells).
template <class Visit>
void for_cells_of_row(const AnalyticCells& c, std::size_t image_width, std::size_t row, const Visit& visit) {
  const std::size_t k = static_cast<std::size_t>(c.per_pixel), width = static_cast<std::size_t>(c.view.width);
  const std::size_t first = (static_cast<std::size_t>(c.top) + row) * image_width + static_cast<std::size_t>(c.left);
  for (std::size_t y = row * k; y < (row + 1) * k; ++y)
    for (std::size_t x = 0; x < width; ++x) visit(y * width + x, first + x / k);
}

}  // namespace

GBuffer make_cells(const AnalyticCells& cells, const GBuffer& image) {
  GBuffer g;
  clear_gbuffer(cells.view, {.center = false, .analytic = true}, g);
  if (image.opaque_depth.empty()) return g;
  g.opaque_depth.resize(g.coverage.size());
  const std::size_t samples = static_cast<std::size_t>(image.samples);
  parallel_for(static_cast<std::size_t>(cells.view.height / cells.per_pixel), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      for_cells_of_row(cells, static_cast<std::size_t>(image.width), row, [&](std::size_t cell, std::size_t pixel) {
        const float* depth = &image.opaque_depth[pixel * samples];
        g.opaque_depth[cell] = depth[cell % samples];
      });
  });
  return g;
}

void average_cells(const AnalyticCells& cells, const GBuffer& from, GBuffer& image) {
  const std::size_t k = static_cast<std::size_t>(cells.per_pixel), columns = static_cast<std::size_t>(cells.view.width) / k;
  parallel_for(static_cast<std::size_t>(cells.view.height) / k, 1, [&](std::size_t begin, std::size_t end) {
    struct Sum {
      double area = 0;
      std::int64_t cos2 = 0, sin2 = 0;
    };
    std::vector<Sum> sums(columns);
    for (std::size_t row = begin; row < end; ++row) {
      const std::size_t first = (static_cast<std::size_t>(cells.top) + row) * static_cast<std::size_t>(image.width) +
                                static_cast<std::size_t>(cells.left);
      std::fill(sums.begin(), sums.end(), Sum());
      for_cells_of_row(cells, static_cast<std::size_t>(image.width), row, [&](std::size_t cell, std::size_t pixel) {
        Sum& sum = sums[pixel - first];
        sum.area += analytic_coverage(from, cell);
        sum.cos2 += from.tangent_cos2[cell], sum.sin2 += from.tangent_sin2[cell];
      });
      for (std::size_t x = 0; x < columns; ++x) {
        const double mean = sums[x].area / static_cast<double>(k * k);
        const double depth = mean < 1 ? std::min(-std::log1p(-mean), static_cast<double>(kMaxStrandDepth)) : kMaxStrandDepth;
        image.coverage[first + x] = static_cast<std::uint32_t>(depth / GBuffer::kCoverageUnit + 0.5);
        const std::int64_t cells_of_pixel = static_cast<std::int64_t>(k * k);
        image.tangent_cos2[first + x] = static_cast<std::int32_t>(sums[x].cos2 / cells_of_pixel);
        image.tangent_sin2[first + x] = static_cast<std::int32_t>(sums[x].sin2 / cells_of_pixel);
      }
    }
  });
}

}  // namespace pelage
