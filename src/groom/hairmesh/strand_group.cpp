#include "groom/hairmesh/strand_group.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "groom/hairmesh/strand_traits.h"
#include "kernel/lanes_scalar.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "groom/hairmesh/strand_group.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"
#include "kernel/lanes-inl.h"

#ifndef PELAGE_LANES_FN
#define PELAGE_LANES_FN HWY_INLINE
#endif

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace wide {
namespace {
#include "groom/hairmesh/strand_group-inl.h"
}  // namespace
}  // namespace wide

void StrandPoints(const BundleCage& cage, const StrandTraits& traits, StrandGroup& group) {
  static_assert(wide::hn::MaxLanes(wide::FloatTag()) <= StrandGroup::kLanes);
  wide::strand_group(cage, traits, group);
}

}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {
namespace kernel {
namespace {
#include "groom/hairmesh/strand_group-inl.h"
}  // namespace
}  // namespace kernel

HWY_EXPORT(StrandPoints);

namespace {

/// Sizes the group, and draws what is random about its strands.
StrandTraits begin_group(const BundleCage& cage, std::uint32_t first, std::size_t count, std::uint32_t points, StrandGroup& g) {
  PELAGE_CHECK(count >= 1 && count <= StrandGroup::kLanes);
  PELAGE_CHECK(points >= 2 && points <= kHairMeshPoints);
  g.strands = count, g.points = points;
  const std::size_t size = kHairMeshPoints * StrandGroup::kLanes;
  if (g.x.size() < size)
    for (Buffer<float>* b : {&g.x, &g.y, &g.z, &g.tx, &g.ty, &g.tz, &g.width, &g.occlusion}) b->resize(size);
  StrandTraits traits;
  make_traits(cage, first, count, traits);
  g.u = traits.groom_u, g.v = traits.groom_v;
  return traits;
}

}  // namespace

void make_strands(const BundleCage& cage, std::uint32_t first, std::size_t count, std::uint32_t points, StrandGroup& group) {
  const StrandTraits traits = begin_group(cage, first, count, points, group);
  HWY_DYNAMIC_DISPATCH(StrandPoints)(cage, traits, group);
}

void make_strands_scalar(const BundleCage& cage, std::uint32_t first, std::size_t count, std::uint32_t points,
                         StrandGroup& group) {
  const StrandTraits traits = begin_group(cage, first, count, points, group);
  kernel::strand_group(cage, traits, group);
}

}  // namespace pelage
#endif
