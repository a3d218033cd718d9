// Scalar and wide scattering give the same bits, on every instruction set that this machine has.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernel/scatter/scatter_parity_test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace wide {
#include "kernel/scatter/scatter_parity_cases.inc"
}  // namespace wide

// in and out are [kParity…][n] arrays; n is a multiple of every lane count.
void run_wide(const float* in, float* out, std::size_t n) {
  const std::size_t step = static_cast<std::size_t>(wide::lanes());
  for (std::size_t i = 0; i < n; i += step) {
    std::size_t next = 0;
    wide::scatter_parity_cases([&](std::size_t k) { return wide::load(in + k * n + i); },
                               [&](wide::Float v) { wide::store(v, out + next++ * n + i); });
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <bit>
#include <cmath>
#include <vector>

#include "core/rng.h"
#include "kernel/scalar.h"

namespace pelage {
namespace kernel {
#include "kernel/scatter/scatter_parity_cases.inc"
}  // namespace kernel

HWY_EXPORT(run_wide);

namespace {

constexpr std::size_t kCases = 1 << 16;

// Uniform inputs, a quarter of them pushed to 0 or almost 1: the extremes of every parameter.
std::vector<float> parity_inputs() {
  std::vector<float> in(kernel::kParityInputs * kCases);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const RandomBits r = pcg4d(static_cast<std::uint32_t>(i), 17, 4, 2026);
    const float extreme = (r.y & 4u) != 0 ? 0.99999994f : 0.f;
    in[i] = (r.y & 3u) == 0 ? extreme : uniform_from_bits(r.x);
  }
  return in;
}

TEST(ScatterParity, WideEqualsScalarBitForBit) {
  const std::vector<float> in = parity_inputs();
  std::vector<float> expected(kernel::kParityOutputs * kCases), out(expected.size());
  for (std::size_t i = 0; i < kCases; ++i) {
    std::size_t next = 0;
    kernel::scatter_parity_cases([&](std::size_t k) { return in[k * kCases + i]; },
                                 [&](float v) { expected[next++ * kCases + i] = v; });
    ASSERT_EQ(next, kernel::kParityOutputs);
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_TRUE(std::isfinite(expected[i])) << "output " << i / kCases << " of case " << i % kCases;
  }
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    out.assign(out.size(), NAN);
    HWY_DYNAMIC_DISPATCH(run_wide)(in.data(), out.data(), kCases);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(std::bit_cast<std::uint32_t>(out[i]), std::bit_cast<std::uint32_t>(expected[i]))
          << hwy::TargetName(target) << ": output " << i / kCases << " of case " << i % kCases << ": " << out[i]
          << " instead of " << expected[i];
    }
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace pelage
#endif  // HWY_ONCE
