// Who belongs to whom: strands to guides, and within a guide's lock to small tufts.
#pragma once

#include <cstdint>
#include <vector>

#include "groom/guides.h"

namespace pelage::groom {

inline constexpr int kBlend = 3;  ///< guides that shape a strand near its root

/// The place of one strand in the hierarchy.
struct Membership {
  std::uint32_t guide[kBlend];  ///< nearest first
  float weight[kBlend];         ///< sum 1; 0 for guides beyond the parting
  std::uint32_t tuft;           ///< root whose offset the strand's tip approaches; itself at the middle of a tuft
};

/// Tufts gather about `tuft_size` strands around the first roots of a lock.
std::vector<Membership> find_memberships(const GuideSet& guides, const std::vector<Root>& roots, int tuft_size);

/// Root indices sorted by nearest guide, then by index.
std::vector<std::uint32_t> order_by_guide(const std::vector<Membership>& members, std::size_t guide_count);

}  // namespace pelage::groom
