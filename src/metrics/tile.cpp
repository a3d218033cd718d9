// Separable convolution, many pixels at a time. The order of a pixel's sum is that of the taps on every instruction set,
// without fused multiply-add: the same bits everywhere.
#include "metrics/tile.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "metrics/tile.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pelage::metrics {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// out[i] = Σ_k taps[k] in[i + k·stride]
void weighted_sum(const float* in, std::size_t stride, const float* taps, std::size_t tap_count, std::size_t count,
                  float* out) {
  const hn::ScalableTag<float> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    auto sum = hn::Mul(hn::Set(d, taps[0]), hn::LoadU(d, in + i));
    for (std::size_t k = 1; k < tap_count; ++k)
      sum = hn::Add(sum, hn::Mul(hn::Set(d, taps[k]), hn::LoadU(d, in + i + k * stride)));
    hn::StoreU(sum, d, out + i);
  }
  for (; i < count; ++i) {
    float sum = taps[0] * in[i];
    for (std::size_t k = 1; k < tap_count; ++k) sum = sum + taps[k] * in[i + k * stride];
    out[i] = sum;
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelage::metrics
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage::metrics {

HWY_EXPORT(weighted_sum);

Block gather(const Image& image, std::size_t channel, const Tile& tile, int radius) {
  Block block(tile.width + 2 * radius, tile.height + 2 * radius);
  const std::size_t stride = image.channel_count();
  for (int y = 0; y < block.height; ++y) {
    const float* from = image.at(0, std::clamp(tile.y + y - radius, 0, image.height - 1)) + channel;
    float* to = block.row(y);
    for (int x = 0; x < block.width; ++x)
      to[x] = from[static_cast<std::size_t>(std::clamp(tile.x + x - radius, 0, image.width - 1)) * stride];
  }
  return block;
}

Block convolve_rows(const Block& in, std::span<const float> taps) {
  Block out(in.width - static_cast<int>(taps.size()) + 1, in.height);
  for (int y = 0; y < out.height; ++y)
    HWY_DYNAMIC_DISPATCH(weighted_sum)(in.row(y), 1, taps.data(), taps.size(), static_cast<std::size_t>(out.width), out.row(y));
  return out;
}

Block convolve_columns(const Block& in, std::span<const float> taps) {
  Block out(in.width, in.height - static_cast<int>(taps.size()) + 1);
  // Rows of a block follow each other without a gap: all of them are one run.
  HWY_DYNAMIC_DISPATCH(weighted_sum)
  (in.row(0), static_cast<std::size_t>(in.width), taps.data(), taps.size(), out.values.size(), out.row(0));
  return out;
}

Block convolve(const Block& in, std::span<const float> horizontal, std::span<const float> vertical) {
  return convolve_columns(convolve_rows(in, horizontal), vertical);
}

Block crop(const Block& in, int margin) {
  Block out(in.width - 2 * margin, in.height - 2 * margin);
  for (int y = 0; y < out.height; ++y) std::copy_n(in.row(y + margin) + margin, out.width, out.row(y));
  return out;
}

}  // namespace pelage::metrics
#endif
