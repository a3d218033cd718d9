// The grooms that benchmarks and tests call by name.
#pragma once

#include <pelage/error.h>
#include <pelage/grow.h>

#include <string>
#include <vector>

namespace pelage {

struct BenchmarkGroom {
  std::string name;
  GrowSettings settings;
};

/// straight50k and curly50k: 50,000 strands of 64 points; curly200k: 200,000 of 64. All on mannequin_head().
inline const std::vector<BenchmarkGroom>& benchmark_grooms() {
  static const std::vector<BenchmarkGroom> grooms = [] {
    const auto make = [](const char* name, HairStyle style, int strands) {
      GrowSettings s = grow_defaults(style);
      s.strands = strands, s.points = 64;
      return BenchmarkGroom{name, s};
    };
    return std::vector<BenchmarkGroom>{make("straight50k", HairStyle::kStraight, 50000),
                                       make("curly50k", HairStyle::kCurly, 50000),
                                       make("curly200k", HairStyle::kCurly, 200000)};
  }();
  return grooms;
}

/// Grows the benchmark groom called `name`. Throws Error on an unknown name.
inline StrandSet benchmark_groom(const std::string& name) {
  for (const BenchmarkGroom& groom : benchmark_grooms())
    if (groom.name == name) return grow(groom.settings, mannequin_head());
  throw Error("groom", name, "no benchmark groom has this name", "straight50k, curly50k or curly200k");
}

}  // namespace pelage
