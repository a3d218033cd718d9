// Clusters of points of any dimension.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pelage {

struct Features {
  std::size_t dimension = 1;
  std::vector<float> values;  ///< [count][dimension]
  std::size_t count() const { return values.size() / dimension; }
  const float* item(std::size_t i) const { return &values[i * dimension]; }
};

/// The cluster of every item, 0 … clusters − 1, by Lloyd's iteration from a start after Arthur & Vassilvitskii 2007
/// (references.bib: Arthur2007KMeans). No cluster is empty; there are fewer than asked for where fewer items differ. The same
/// for any thread count.
std::vector<std::uint32_t> k_means(const Features& features, std::uint32_t clusters, std::uint32_t seed);

}  // namespace pelage
