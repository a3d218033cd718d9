#include "filter/frame_mean.h"

#include <utility>

#include "core/check.h"
#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kGrain = 1 << 16;

}  // namespace

void FrameMean::add(Image frame) {
  if (count_++ == 0) {
    sum_ = std::move(frame);
    return;
  }
  PELAGE_CHECK_EQ(frame.pixels.size(), sum_.pixels.size());
  parallel_for(frame.pixels.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) sum_.pixels[i] += frame.pixels[i];
  });
}

Image FrameMean::take() {
  PELAGE_CHECK(count_ > 0);
  const float share = 1 / static_cast<float>(count_);
  parallel_for(sum_.pixels.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) sum_.pixels[i] *= share;
  });
  count_ = 0;
  return std::exchange(sum_, {});
}

}  // namespace pelage
