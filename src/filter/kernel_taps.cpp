#include "filter/kernel_taps.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace pelage {
namespace {

float inverse_square(float sigma) { return std::isinf(sigma) ? 0 : 1 / (sigma * sigma); }

kernel::FilterKernel terms_of(const AnisotropicKernel& k) {
  const float major = std::max(0.5f, k.radius), minor = std::max(0.5f, k.radius * k.aspect);
  kernel::FilterKernel f;
  f.inverse_major2 = inverse_square(major), f.inverse_minor2 = inverse_square(minor);
  f.inverse_distance2 = inverse_square(major * k.sigma_distance);
  f.inverse_angle2 = inverse_square(k.sigma_angle), f.inverse_color2 = inverse_square(k.sigma_color);
  f.half_inverse_along2 = inverse_square(major * k.sigma_along) / 2;
  f.half_inverse_across2 = inverse_square(minor * k.sigma_across) / 2;
  return f;
}

struct Pairs {
  std::vector<std::int32_t> offset;
  std::vector<float> weight;
};

Pairs pairs_along(Vec2 tangent, const kernel::FilterKernel& k, int reach, std::size_t stride) {
  Pairs pairs;
  for (int j = 0; j <= reach; ++j)
    for (int i = j == 0 ? 1 : -reach; i <= reach; ++i) {
      const float dx = static_cast<float>(i), dy = static_cast<float>(j);
      const float along = dx * tangent.x + dy * tangent.y, across = dx * tangent.y - dy * tangent.x;
      if (!kernel::filter_inside(k, along, across)) continue;
      float exponent = kernel::filter_distance_exponent(k, along, across);
      if (k.inverse_angle2 > 0) {
        const float angle = kernel::filter_angle(along, across);
        exponent += angle * angle * k.inverse_angle2;
      }
      pairs.offset.push_back(j * static_cast<std::int32_t>(stride) + i);
      pairs.weight.push_back(kernel::m_exp(-exponent));
    }
  return pairs;
}

}  // namespace

Vec2 DirectionCells::middle(int cell) {
  const float turned = static_cast<float>(cell) / (kHalf / 2), share = turned < 2 ? 1 - turned : turned - 3;
  return MeanDirection::halved({share, (turned < 2 ? 1 : -1) * (1 - std::fabs(share))});
}

KernelTable::KernelTable(const AnisotropicKernel& kernel, std::size_t stride) : terms_(terms_of(kernel)) {
  constexpr auto directions = static_cast<std::size_t>(DirectionCells::kDirections);
  std::vector<Pairs> by_cell(static_cast<std::size_t>(KernelVariants::count(kernel)) * directions);
  parallel_for(by_cell.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell) {
      const AnisotropicKernel variant = KernelVariants::kernel(kernel, static_cast<int>(cell / directions));
      by_cell[cell] =
          pairs_along(DirectionCells::middle(static_cast<int>(cell % directions)), terms_of(variant), variant.reach(), stride);
    }
  });
  for (const Pairs& pairs : by_cell) {
    first_.push_back(offset_.size());
    offset_.insert(offset_.end(), pairs.offset.begin(), pairs.offset.end());
    weight_.insert(weight_.end(), pairs.weight.begin(), pairs.weight.end());
    sum_.push_back(1 + 2 * std::accumulate(pairs.weight.begin(), pairs.weight.end(), 0.f));
  }
  first_.push_back(offset_.size());
}

std::size_t KernelTable::most_pairs() const {
  std::size_t most = 0;
  for (std::size_t cell = 0; cell + 1 < first_.size(); ++cell) most = std::max(most, first_[cell + 1] - first_[cell]);
  return most;
}

}  // namespace pelage
