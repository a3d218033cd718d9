#include "filter/kernel_field.h"

#include <algorithm>
#include <cmath>

#include "filter/kernel_taps.h"

namespace pelage {
namespace {

Vec4 sum(const Vec4& a, const Vec4& b) { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w}; }

}  // namespace

int KernelVariants::of(float thickness, float agreement) {
  int size = 0;
  for (float w = kThin * 1.41421356f; size + 1 < kSizes && thickness > w; w *= 2) ++size;
  const int shape = static_cast<int>(std::clamp(agreement, 0.f, 1.f) * (kShapes - 1) + 0.5f);
  return size * kShapes + shape;
}

AnisotropicKernel KernelVariants::kernel(const AnisotropicKernel& thin, int variant) {
  AnisotropicKernel k = thin;
  if (!thin.adapts) return k;
  const float agreement = static_cast<float>(variant % kShapes) / (kShapes - 1);
  const float major = std::max(kLeastAxis, thin.radius * std::exp2(-0.5f * static_cast<float>(variant / kShapes)));
  const float aspect = std::max(kLeastAxis, major * thin.aspect) / major;
  k.aspect = std::pow(aspect, agreement);
  k.radius = std::min(major * std::sqrt(aspect / k.aspect), thin.radius);
  return k;
}

KernelField::KernelField(const Matte& matte, const AnisotropicKernel& kernel) : matte_(matte), adapts_(kernel.adapts) {
  if (adapts_) hair_.resize(static_cast<std::size_t>(matte.width + 2 * kReach));
}

void KernelField::load(int first, int last) {
  if (!adapts_) return;
  first_ = first;
  const std::size_t width = static_cast<std::size_t>(matte_.width);
  sums_.resize(width * static_cast<std::size_t>(last - first + 2 * kReach));
  Vec4* row = sums_.data();
  for (int y = first - kReach; y < last + kReach; ++y, row += width) {
    std::fill(hair_.begin(), hair_.end(), Vec4());
    if (y >= 0 && y < matte_.height)
      matte_.hair.for_each(static_cast<std::size_t>(y), static_cast<std::size_t>(y) + 1, [&](int x, int) {
        const std::size_t p = matte_.index(x, y);
        const Vec2 d = MeanDirection::doubled(matte_.tangent[p]);
        hair_[static_cast<std::size_t>(x + kReach)] = {d.x, d.y, matte_.thickness[p], 1};
      });
    for (std::size_t x = 0; x < width; ++x) {
      Vec4 s = hair_[x];
      for (std::size_t i = 1; i <= 2 * kReach; ++i) s = sum(s, hair_[x + i]);
      row[x] = s;
    }
  }
}

KernelChoice KernelField::at(int x, int y) const {
  if (!adapts_) {
    const Vec2 d = MeanDirection::doubled(matte_.tangent[matte_.index(x, y)]);
    return d == Vec2() ? KernelChoice() : KernelChoice{0, DirectionCells::cell_of(d)};
  }
  const std::size_t width = static_cast<std::size_t>(matte_.width);
  const Vec4* row = &sums_[static_cast<std::size_t>(y - first_) * width + static_cast<std::size_t>(x)];
  Vec4 s = row[0];
  for (std::size_t j = 1; j <= 2 * kReach; ++j) s = sum(s, row[j * width]);
  const Vec2 d(s.x, s.y);
  if (d == Vec2()) return {};
  return {KernelVariants::of(s.z / s.w, std::sqrt(dot(d, d)) / s.w), DirectionCells::cell_of(d)};
}

}  // namespace pelage
