// The curve of one strand by arc length, for code that runs once per strand.
#pragma once

#include <pelage/strand_set.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pelage {

/// A strand as a polyline of points on its curve: every control point's place and a few between. Refilled strand after strand,
/// it allocates once.
class StrandPath {
 public:
  struct Knot {
    Vec3 p;
    float width;  ///< diameter, metres
    double s;     ///< arc length from the root, metres
  };

  /// The path of strand `s` of `set`.
  void assign(const StrandSet& set, std::size_t s);

  const std::vector<Knot>& knots() const { return knots_; }
  double length() const { return knots_.empty() ? 0 : knots_.back().s; }

  /// Calls put(i, knot before, knot after, share between them) for `count` places uniform in arc length, both ends among them.
  template <class Put>
  void walk(std::size_t count, const Put& put) const {
    std::size_t k = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double s = knots_.back().s * static_cast<double>(i) / static_cast<double>(count - 1);
      while (k + 2 < knots_.size() && knots_[k + 1].s < s) ++k;
      const double step = knots_[k + 1].s - knots_[k].s;
      put(i, knots_[k], knots_[k + 1], static_cast<float>(step > 0 ? std::clamp((s - knots_[k].s) / step, 0., 1.) : 0.));
    }
  }

 private:
  std::vector<Knot> knots_;
};

}  // namespace pelage
