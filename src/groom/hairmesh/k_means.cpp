#include "groom/hairmesh/k_means.h"

#include <algorithm>
#include <limits>

#include "core/parallel.h"
#include "core/rng.h"

namespace pelage {
namespace {

constexpr int kRounds = 25;

float distance2(const float* a, const float* b, std::size_t dimension) {
  float sum = 0;
  for (std::size_t d = 0; d < dimension; ++d) sum += (a[d] - b[d]) * (a[d] - b[d]);
  return sum;
}

/// Each center an item, drawn with a chance that grows with the square of its distance to those before.
std::vector<float> first_centers(const Features& f, std::uint32_t clusters, std::uint32_t seed) {
  Rng random(seed, 0x6b6d);
  std::vector<float> centers, nearest(f.count(), std::numeric_limits<float>::max());
  auto chosen = std::min(static_cast<std::size_t>(random.uniform() * static_cast<float>(f.count())), f.count() - 1);
  for (std::uint32_t c = 0; c < clusters; ++c) {
    centers.insert(centers.end(), f.item(chosen), f.item(chosen) + f.dimension);
    double total = 0;
    for (std::size_t i = 0; i < f.count(); ++i) {
      nearest[i] = std::min(nearest[i], distance2(f.item(i), f.item(chosen), f.dimension));
      total += static_cast<double>(nearest[i]);
    }
    if (!(total > 0)) break;
    double rest = static_cast<double>(random.uniform()) * total;
    for (std::size_t i = 0; i < f.count(); ++i) {
      if (nearest[i] > 0) chosen = i;
      rest -= static_cast<double>(nearest[i]);
      if (rest < 0) break;
    }
  }
  return centers;
}

/// Means of the clusters, summed in order; true for those that have items.
std::vector<bool> move_centers(const Features& f, const std::vector<std::uint32_t>& label, std::vector<float>& centers) {
  const std::size_t clusters = centers.size() / f.dimension;
  std::vector<double> sums(centers.size());
  std::vector<std::size_t> counts(clusters);
  for (std::size_t i = 0; i < f.count(); ++i) {
    ++counts[label[i]];
    for (std::size_t d = 0; d < f.dimension; ++d) sums[label[i] * f.dimension + d] += static_cast<double>(f.item(i)[d]);
  }
  std::vector<bool> used(clusters);
  for (std::size_t c = 0; c < clusters; ++c) {
    used[c] = counts[c] > 0;
    for (std::size_t d = 0; used[c] && d < f.dimension; ++d)
      centers[c * f.dimension + d] = static_cast<float>(sums[c * f.dimension + d] / static_cast<double>(counts[c]));
  }
  return used;
}

}  // namespace

std::vector<std::uint32_t> k_means(const Features& f, std::uint32_t clusters, std::uint32_t seed) {
  std::vector<std::uint32_t> label(f.count());
  if (f.count() == 0) return label;
  std::vector<float> centers = first_centers(f, clusters, seed);
  const std::size_t count = centers.size() / f.dimension;
  std::vector<bool> used;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<std::uint32_t> before = label;
    parallel_for(f.count(), 512, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        float least = std::numeric_limits<float>::max();
        for (std::size_t c = 0; c < count; ++c) {
          const float d = distance2(f.item(i), &centers[c * f.dimension], f.dimension);
          if (d < least) least = d, label[i] = static_cast<std::uint32_t>(c);
        }
      }
    });
    used = move_centers(f, label, centers);
    if (round > 0 && label == before) break;
  }
  std::vector<std::uint32_t> name(count);
  std::uint32_t next = 0;
  for (std::size_t c = 0; c < count; ++c)
    if (used[c]) name[c] = next++;
  for (std::uint32_t& l : label) l = name[l];
  return label;
}

}  // namespace pelage
