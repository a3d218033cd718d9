#include "frame/strand_path.h"

#include <cstdint>

#include "frame/curve_basis.h"
#include "kernel/scalar.h"

namespace pelage {

void StrandPath::assign(const StrandSet& set, std::size_t s) {
  const std::uint32_t first = set.offsets[s], n = set.offsets[s + 1] - first;
  const bool bezier = set.basis == CurveBasis::kBezier;
  const std::uint32_t pieces = set.basis == CurveBasis::kLinear ? 1 : 4, spans = bezier ? (n - 1) / 3 : n - 1;
  // StrandSet: phantom points continue the ends.
  const auto point = [&](std::int64_t i) {
    if (i < 0) return set.points[first] * 2.f - set.points[first + 1];
    if (i >= n) return set.points[first + n - 1] * 2.f - set.points[first + n - 2];
    return set.points[first + static_cast<std::size_t>(i)];
  };
  knots_.clear();
  for (std::uint32_t span = 0; span < spans; ++span)
    for (std::uint32_t k = span == 0 ? 0 : 1; k <= pieces; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(pieces);
      const std::int64_t from = bezier ? std::int64_t{span} * 3 : std::int64_t{span} - 1;
      const std::uint32_t low = first + (bezier ? span * 3 : span), high = low + (bezier ? 3 : 1);
      Knot knot{
          kernel::curve_combine(basis_weights(set.basis, t), point(from), point(from + 1), point(from + 2), point(from + 3)),
          set.width(low) + (set.width(high) - set.width(low)) * t, 0};
      if (!knots_.empty()) knot.s = knots_.back().s + static_cast<double>(pelage::length(knot.p - knots_.back().p));
      knots_.push_back(knot);
    }
}

}  // namespace pelage
