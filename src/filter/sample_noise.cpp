#include "filter/sample_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 8;

/// Sums over the pairs of neighbors of some rows.
struct Differences {
  double same = 0, other = 0;
  std::size_t same_count = 0, other_count = 0;

  void add(const HairSamples& s, std::size_t p, std::size_t q) {
    if (!s.is_hair(p) && !s.is_hair(q)) return;
    const Vec3 d = s.color[p] - s.color[q];
    const double square = static_cast<double>(d.x) * static_cast<double>(d.x) +
                          static_cast<double>(d.y) * static_cast<double>(d.y) +
                          static_cast<double>(d.z) * static_cast<double>(d.z);
    const bool is_same = s.strand_key(p) == s.strand_key(q);
    (is_same ? same : other) += square, ++(is_same ? same_count : other_count);
  }
};

}  // namespace

float color_noise(const HairSamples& s) {
  const auto width = static_cast<std::size_t>(s.width), height = static_cast<std::size_t>(s.height);
  std::vector<Differences> parts((height + kRowsPerTask - 1) / kRowsPerTask);
  parallel_for(height, kRowsPerTask, [&](std::size_t first, std::size_t last) {
    Differences& sum = parts[first / kRowsPerTask];
    for (std::size_t y = first; y < last; ++y)
      for (std::size_t x = 0, p = y * width; x < width; ++x, ++p) {
        if (x + 1 < width) sum.add(s, p, p + 1);
        if (y + 1 == height) continue;
        sum.add(s, p, p + width);
        if (x + 1 < width) sum.add(s, p, p + width + 1);
        if (x > 0) sum.add(s, p, p + width - 1);
      }
  });
  Differences all;
  for (const Differences& part : parts) {
    all.same += part.same, all.same_count += part.same_count;
    all.other += part.other, all.other_count += part.other_count;
  }
  if (!(all.same > 0)) return 0;
  if (!(all.other > 0)) return 1;
  const double ratio = all.same / static_cast<double>(all.same_count) * static_cast<double>(all.other_count) / all.other;
  return static_cast<float>(std::min(1.0, ratio));
}

float kernel_scale_for_noise(float noise) { return 1 + 1.1f * noise; }

}  // namespace pelage
