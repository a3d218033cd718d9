// parallel_for: every item once, the same ranges for any number of threads, exceptions reach the caller.
#include "core/parallel.h"

#include <pelage/error.h>
#include <pelage/runtime.h>

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace pelage {
namespace {

class Parallel : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override { set_thread_count(GetParam()); }
  void TearDown() override { set_thread_count(0); }
};

TEST_P(Parallel, EveryItemOnceInRangesThatStartAtMultiplesOfTheGrain) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{8}, std::size_t{1001}}) {
    std::vector<int> visits(count);
    parallel_for(count, 8, [&](std::size_t begin, std::size_t end) {
      EXPECT_EQ(begin % 8, 0u);
      EXPECT_TRUE(end == begin + 8 || end == count);
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    for (const int v : visits) EXPECT_EQ(v, 1);
  }
}

TEST_P(Parallel, ExceptionReachesTheCaller) {
  EXPECT_THROW(parallel_for(100, 1,
                            [](std::size_t begin, std::size_t) {
                              if (begin == 57) throw std::runtime_error("57");
                            }),
               std::runtime_error);
}

TEST_P(Parallel, LoopsNest) {
  std::atomic<int> sum{0};
  parallel_for(10, 1, [&](std::size_t, std::size_t) {
    parallel_for(10, 3, [&](std::size_t begin, std::size_t end) { sum += static_cast<int>(end - begin); });
  });
  EXPECT_EQ(sum, 100);
}

INSTANTIATE_TEST_SUITE_P(Threads, Parallel, ::testing::Values(1, 2, 5));

TEST(Runtime, ThreadsAndInstructionSetsAreChecked) {
  EXPECT_THROW(set_thread_count(-1), Error);
  EXPECT_THROW(set_isa("Z80"), Error);
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    EXPECT_EQ(active_isa(), isa);
  }
  set_isa("");
  EXPECT_EQ(active_isa(), available_isas().front());
}

}  // namespace
}  // namespace pelage
