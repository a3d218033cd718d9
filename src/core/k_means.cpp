#include "core/k_means.h"

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
    const float* last = f.item(chosen);
    parallel_for(f.count(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) nearest[i] = std::min(nearest[i], distance2(f.item(i), last, f.dimension));
    });
    for (const float d : nearest) total += static_cast<double>(d);
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

CenterTable::CenterTable(const float* centers, std::size_t count, std::size_t dimension)
    : count_(count), dimension_(dimension), values_(padded_count() * dimension) {
  for (std::size_t c = 0; c < count; ++c)
    for (std::size_t d = 0; d < dimension; ++d)
      values_[(c / kBlock * dimension + d) * kBlock + c % kBlock] = centers[c * dimension + d];
}

void CenterTable::distances2(const float* item, float* out) const {
  for (std::size_t block = 0; block < padded_count(); block += kBlock) {
    const float* value = &values_[block * dimension_];
    float sum[kBlock] = {};
    for (std::size_t d = 0; d < dimension_; ++d, value += kBlock)
      for (std::size_t i = 0; i < kBlock; ++i) {
        const float off = item[d] - value[i];
        sum[i] += off * off;
      }
    std::copy(sum, sum + kBlock, out + block);
  }
}

std::vector<std::uint32_t> k_means(const Features& f, std::uint32_t clusters, std::uint32_t seed) {
  std::vector<std::uint32_t> label(f.count());
  if (f.count() == 0) return label;
  std::vector<float> centers = first_centers(f, clusters, seed);
  const std::size_t count = centers.size() / f.dimension;
  std::vector<bool> used;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<std::uint32_t> before = label;
    const CenterTable table(centers.data(), count, f.dimension);
    parallel_for(f.count(), 512, [&](std::size_t begin, std::size_t end) {
      std::vector<float> d2(table.padded_count());
      for (std::size_t i = begin; i < end; ++i) {
        table.distances2(f.item(i), d2.data());
        const auto nearest =
            std::min_element(d2.begin(), d2.begin() + static_cast<std::ptrdiff_t>(count));  // the first of equals
        label[i] = static_cast<std::uint32_t>(nearest - d2.begin());
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
