#include "core/nearest.h"

#include <gtest/gtest.h>

namespace pelage {
namespace {

TEST(Nearest, DistanceCountsEdits) {
  EXPECT_EQ(edit_distance("", ""), 0);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("abc", ""), 3);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("redner", "render"), 1) << "a swap is one edit";
  EXPECT_EQ(edit_distance("Render", "render"), 0) << "case is free";
}

TEST(Nearest, IsSymmetric) {
  const std::vector<std::string> words{"render", "grow", "info", "convert", "bench", ""};
  for (const auto& a : words)
    for (const auto& b : words) EXPECT_EQ(edit_distance(a, b), edit_distance(b, a)) << a << " " << b;
}

TEST(Nearest, FindsTheWordThatWasMeant) {
  const std::vector<std::string> verbs{"info", "convert", "grow", "render", "bench"};
  EXPECT_EQ(nearest_name("rendr", verbs), "render");
  EXPECT_EQ(nearest_name("redner", verbs), "render");
  EXPECT_EQ(nearest_name("covnert", verbs), "convert");
  EXPECT_EQ(nearest_name("x", {}), "");
}

}  // namespace
}  // namespace pelage
