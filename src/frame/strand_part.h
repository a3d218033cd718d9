// Which strands of a groom are drawn, whole or in parts.
#pragma once

#include <pelage/scene.h>

#include <cstddef>
#include <cstdint>

#include "frame/curve_basis.h"

namespace pelage {

inline StrandPart whole_strand(const StrandSet& set, std::size_t strand) {
  return {static_cast<std::uint32_t>(strand), 0, span_count(set.basis, set.offsets[strand + 1] - set.offsets[strand])};
}

/// How many strands and parts of strands of a groom are drawn.
inline std::size_t drawn_parts(const GroomInstance& groom) {
  return groom.only ? groom.only->size() : groom.strands->strand_count();
}

/// The one at number i, below drawn_parts().
inline StrandPart drawn_part(const GroomInstance& groom, std::size_t i) {
  return groom.only ? (*groom.only)[i] : whole_strand(*groom.strands, i);
}

/// Control point that a part starts at; it reaches `spans` · points_per_span() further.
inline std::uint32_t first_point(const StrandSet& set, const StrandPart& part) {
  return set.offsets[part.strand] + part.first_span * points_per_span(set.basis);
}

}  // namespace pelage
