// Small scenes for the path tracer, and means of what it samples.
#pragma once

#include <pelage/scene.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/rng.h"
#include "reference/path_tracer.h"

namespace pelage::kit {

/// Strands of the given points, one width.
inline std::shared_ptr<StrandSet> strands(const std::vector<std::vector<Vec3>>& all, float width,
                                          CurveBasis basis = CurveBasis::kCatmullRom) {
  auto set = std::make_shared<StrandSet>();
  set->basis = basis, set->widths = {width}, set->offsets = {0};
  for (const std::vector<Vec3>& points : all) {
    set->points.insert(set->points.end(), points.begin(), points.end());
    set->offsets.push_back(static_cast<std::uint32_t>(set->points.size()));
  }
  return set;
}

/// A ball of bent strands through random places of the unit ball, scaled to `radius`.
inline std::shared_ptr<StrandSet> ball(std::uint32_t count, float radius, float width) {
  std::vector<std::vector<Vec3>> all;
  for (std::uint32_t i = 0; i < count; ++i) {
    Rng rng(5, i);
    const auto inside = [&] {
      for (;;) {
        const Vec3 p(2 * rng.uniform() - 1, 2 * rng.uniform() - 1, 2 * rng.uniform() - 1);
        if (dot(p, p) < 1) return p;
      }
    };
    const Vec3 middle = inside() * (0.8f * radius), along = inside() * (0.4f * radius), bend = inside() * (0.1f * radius);
    all.push_back({middle - along, middle - along * 0.3f + bend, middle + along * 0.3f, middle + along});
  }
  return strands(all, width);
}

/// An orthographic camera on the +Z side that sees `height` metres, around a picture of size × size pixels.
inline Scene scene_of(std::shared_ptr<const StrandSet> set, float height, int size) {
  Scene scene;
  scene.grooms.emplace_back();
  scene.grooms[0].strands = std::move(set);
  scene.camera.projection = Camera::Projection::kOrthographic;
  scene.camera.height = height, scene.camera.eye = {0, 0, 1};
  scene.settings.width = scene.settings.height = size;
  return scene;
}

inline Image gradient_map(int width, int height) {
  Image map(width, height, {"R", "G", "B"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float* c = map.at(x, y);
      const float fx = static_cast<float>(x) / static_cast<float>(width),
                  fy = static_cast<float>(y) / static_cast<float>(height);
      c[0] = 0.2f + fx, c[1] = 0.4f + 0.3f * fy, c[2] = 1 - fy;
      if (x == width / 5 && y == height / 3) c[0] = 60, c[1] = 50, c[2] = 40;  // a small sun
    }
  return map;
}

/// Mean, and variance of the mean, of a channel over samples.
struct Estimate {
  double mean = 0, variance = 0;
  std::uint64_t count = 0;
};

/// Mean luminance of what samples 0 … count − 1 of each pixel bring back, over the pixels for which `use` holds of a sample.
template <class Use>
Estimate estimate(const PathTracer& tracer, const Scene& scene, std::uint32_t count, const Use& use) {
  const int width = scene.settings.width, height = scene.settings.height;
  std::vector<Estimate> rows(static_cast<std::size_t>(height));
  parallel_for(rows.size(), 1, [&](std::size_t y, std::size_t) {
    Estimate& row = rows[y];
    for (int x = 0; x < width; ++x)
      for (std::uint32_t i = 0; i < count; ++i) {
        const PathSample s = tracer.sample(x, static_cast<int>(y), i);
        if (!use(s)) continue;
        const double v = static_cast<double>(0.2126f * s.radiance.x + 0.7152f * s.radiance.y + 0.0722f * s.radiance.z);
        row.mean += v, row.variance += v * v, ++row.count;
      }
  });
  Estimate sum;
  for (const Estimate& row : rows) sum.mean += row.mean, sum.variance += row.variance, sum.count += row.count;
  const double n = static_cast<double>(sum.count);
  sum.mean /= n;
  sum.variance = (sum.variance / n - sum.mean * sum.mean) / n;
  return sum;
}
inline Estimate estimate(const PathTracer& tracer, const Scene& scene, std::uint32_t count) {
  return estimate(tracer, scene, count, [](const PathSample& s) { return s.hair; });
}

}  // namespace pelage::kit
