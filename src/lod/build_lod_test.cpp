// The chain of thick hairs: what must hold for any groom.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/grow.h>
#include <pelage/lod.h>
#include <pelage/runtime.h>

namespace pelage {
namespace {

StrandSet groom(HairStyle style, int strands, int points = 32) {
  GrowSettings s = grow_defaults(style);
  s.strands = strands, s.points = points;
  return grow(s, mannequin_head());
}

TEST(BuildLod, SatisfiesItsRules) {
  for (const HairStyle style : {HairStyle::kStraight, HairStyle::kCurly}) {
    const StrandSet strands = groom(style, 3000);
    const LodHierarchy lod = build_lod(strands, {.levels = 4, .guides = 48, .memory_share = 5});
    validate(lod, strands, "test");
    EXPECT_GE(lod.levels(), 3u);
  }
}

}  // namespace
}  // namespace pelage
