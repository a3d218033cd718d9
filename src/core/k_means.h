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

/// Points that many others are measured against: kBlock of them side by side, so that a machine takes them together.
class CenterTable {
 public:
  static constexpr std::size_t kBlock = 16;

  CenterTable(const float* centers, std::size_t count, std::size_t dimension);
  explicit CenterTable(const Features& centers) : CenterTable(centers.values.data(), centers.count(), centers.dimension) {}

  std::size_t count() const { return count_; }
  std::size_t padded_count() const { return (count_ + kBlock - 1) / kBlock * kBlock; }

  /// Squared distances from `item` [dimension] to all centers; `out` [padded_count()], the rest of it is filled with anything.
  /// Each is the sum over the dimensions in order, to the bit.
  void distances2(const float* item, float* out) const;

 private:
  std::size_t count_, dimension_;
  std::vector<float> values_;  ///< [block][dimension][kBlock]
};

/// The cluster of every item, 0 … clusters − 1, by Lloyd's iteration from a start after Arthur & Vassilvitskii 2007
/// (references.bib: Arthur2007KMeans). No cluster is empty; there are fewer than asked for where fewer items differ. The same
/// for any thread count.
std::vector<std::uint32_t> k_means(const Features& features, std::uint32_t clusters, std::uint32_t seed);

}  // namespace pelage
