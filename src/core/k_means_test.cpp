// Clusters against the iteration written out, and what must hold for any input.
#include "core/k_means.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <limits>

#include "core/rng.h"

namespace pelage {
namespace {

Features scattered(std::size_t count, std::size_t dimension) {
  Features f;
  f.dimension = dimension;
  for (std::uint32_t i = 0; i < count * dimension; ++i) f.values.push_back(Rng(7, i).normal());
  return f;
}

TEST(KMeans, FindsHeapsThatStandApart) {
  Features f;
  f.dimension = 2;
  for (int i = 0; i < 300; ++i) {
    const auto heap = static_cast<float>(i % 3), off = 0.01f * static_cast<float>(i % 17);
    f.values.insert(f.values.end(), {10 * heap + off, heap * heap - off});
  }
  const std::vector<std::uint32_t> label = k_means(f, 3, 5);
  for (std::size_t i = 3; i < label.size(); ++i) EXPECT_EQ(label[i], label[i % 3]);
  EXPECT_NE(label[0], label[1]);
  EXPECT_NE(label[1], label[2]);
  EXPECT_NE(label[0], label[2]);
}

TEST(KMeans, HasNoMoreClustersThanItemsDiffer) {
  const Features same{1, {2, 2, 2, 2}};
  EXPECT_THAT(k_means(same, 3, 1), ::testing::Each(0u));
}

// Lloyd's iteration ends where no item is nearer to the mean of another cluster.
TEST(KMeans, EndsWhereEveryItemIsNearestToItsOwnMean) {
  const Features f = scattered(400, 3);
  const std::vector<std::uint32_t> label = k_means(f, 4, 2);
  std::vector<std::vector<double>> mean(4, std::vector<double>(3));
  std::vector<double> count(4);
  for (std::size_t i = 0; i < f.count(); ++i) {
    count[label[i]] += 1;
    for (std::size_t d = 0; d < 3; ++d) mean[label[i]][d] += static_cast<double>(f.item(i)[d]);
  }
  std::size_t strays = 0;
  for (std::size_t i = 0; i < f.count(); ++i) {
    std::vector<double> d2(4);
    for (std::size_t c = 0; c < 4; ++c)
      for (std::size_t d = 0; d < 3; ++d) {
        const double off = static_cast<double>(f.item(i)[d]) - mean[c][d] / count[c];
        d2[c] += off * off;
      }
    strays += d2[label[i]] > *std::min_element(d2.begin(), d2.end()) + 1e-6;
  }
  EXPECT_LE(strays, 8u);  // the iteration stops after 25 rounds
}

TEST(KMeans, IsTheSameForAnyThreadCount) {
  const Features f = scattered(5000, 48);
  set_thread_count(1);
  const std::vector<std::uint32_t> one = k_means(f, 37, 3);
  set_thread_count(0);
  EXPECT_EQ(k_means(f, 37, 3), one);
}

TEST(CenterTable, MeasuresAsTheSumIsWritten) {
  for (const std::size_t count : {1u, 15u, 16u, 17u, 40u}) {
    const Features centers = scattered(count, 48), items = scattered(9, 48);
    const CenterTable table(centers);
    std::vector<float> d2(table.padded_count());
    for (std::size_t i = 0; i < items.count(); ++i) {
      table.distances2(items.item(i), d2.data());
      for (std::size_t c = 0; c < count; ++c) {
        float sum = 0;
        for (std::size_t d = 0; d < 48; ++d)
          sum += (items.item(i)[d] - centers.item(c)[d]) * (items.item(i)[d] - centers.item(c)[d]);
        EXPECT_EQ(d2[c], sum) << count << " " << i << " " << c;
      }
    }
  }
}

}  // namespace
}  // namespace pelage
