// Who belongs to whom: strands to guides, and within a guide's lock to small tufts.
#pragma once

#include <cstdint>
#include <vector>

#include "groom/guides.h"

namespace pelage::groom {

inline constexpr int kBlend = 3;  ///< guides that shape a strand near its root

/// The place of one strand in the hierarchy.
struct Membership {
  std::uint32_t guide[kBlend];  ///< the one to belong to first
  float weight[kBlend];         ///< sum 1
  std::uint32_t tuft;           ///< root whose offset the strand's tip approaches; itself at the middle of a tuft
};

/// Strands follow near guides that are combed their way, never one across the parting where there is another. Tufts gather
/// about `tuft_size` strands of a lock around the first of its roots.
std::vector<Membership> find_memberships(const GrowSettings& settings, const Ground& ground, const GuideSet& guides,
                                         const std::vector<Root>& roots, int tuft_size);

/// Root indices sorted by nearest guide, then by index.
std::vector<std::uint32_t> order_by_guide(const std::vector<Membership>& members, std::size_t guide_count);

}  // namespace pelage::groom
