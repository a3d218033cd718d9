// One formula, three targets: the same inputs through scalar C++, every SIMD target and a Vulkan dispatch.
#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/rng.h"
#include "kernel/scalar.h"
#include "parity/parity_wide.h"
#ifdef PELAGE_HAS_VULKAN
#include "backend/vulkan/vulkan.h"
#endif

namespace pelage::kernel {
#define PELAGE_FN inline
#include "parity/parity.h"
#undef PELAGE_FN
}  // namespace pelage::kernel

namespace pelage {
namespace {

constexpr int kInputs = 8;
constexpr int kSamples = 4096;  // a multiple of every lane count

struct Case {
  std::string name;
  float bound;                // of |GLSL − scalar| / max(1, |scalar|)
  std::vector<float> ranges;  // lower and upper end of each input in use
};

std::vector<float> make_ranges(auto... ends) { return {static_cast<float>(ends)...}; }

std::vector<Case> all_cases() {
  using namespace kernel;
  return {
#define PELAGE_PARITY(name, bound, ranges, expression) Case{#name, bound, make_ranges ranges},
#include "parity/parity_cases.inc"
#undef PELAGE_PARITY
  };
}

void evaluate_scalar(int wanted, const float* inputs, int samples, float* results) {
  using namespace kernel;
  int number = 0;
#define PELAGE_PARITY(name, bound, ranges, expression)                                                                    \
  if (wanted == number++) {                                                                                               \
    for (int i = 0; i < samples; ++i) {                                                                                   \
      [[maybe_unused]] const float a = inputs[i], b = inputs[samples + i], c = inputs[2 * samples + i],                   \
                                   d = inputs[3 * samples + i], e = inputs[4 * samples + i], f = inputs[5 * samples + i], \
                                   g = inputs[6 * samples + i], h = inputs[7 * samples + i];                              \
      const Vec4 v = parity_result(expression);                                                                           \
      results[i] = v.x, results[samples + i] = v.y, results[2 * samples + i] = v.z, results[3 * samples + i] = v.w;       \
    }                                                                                                                     \
  }
#include "parity/parity_cases.inc"
#undef PELAGE_PARITY
}

/// Every corner of the ranges first, then places spread at random inside them.
std::vector<float> make_inputs(const Case& test) {
  std::vector<float> inputs(kInputs * kSamples);
  const int used = static_cast<int>(test.ranges.size() / 2);
  for (int k = 0; k < used; ++k) {
    const float lo = test.ranges[2 * k], hi = test.ranges[2 * k + 1];
    for (int i = 0; i < kSamples; ++i) {
      const float u = i < (1 << used) ? static_cast<float>(i >> k & 1)
                                      : Rng(7, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k)).uniform();
      inputs[k * kSamples + i] = u == 1 ? hi : lo + (hi - lo) * u;
    }
  }
  return inputs;
}

class Parity : public testing::TestWithParam<int> {
 protected:
  Case test_ = all_cases()[GetParam()];
  std::vector<float> inputs_ = make_inputs(test_);
  std::vector<float> scalar_ = std::vector<float>(4 * kSamples);

  void SetUp() override { evaluate_scalar(GetParam(), inputs_.data(), kSamples, scalar_.data()); }
  void TearDown() override { set_isa(""); }

  std::string where(int i) const {
    std::string s = test_.name + "(";
    for (int k = 0; k < kInputs; ++k) s += (k ? ", " : "") + std::to_string(inputs_[k * kSamples + i % kSamples]);
    return s + ")[" + std::to_string(i / kSamples) + "]";
  }
};

TEST_P(Parity, ResultsAreFinite) {
  for (int i = 0; i < 4 * kSamples; ++i) ASSERT_TRUE(std::isfinite(scalar_[i])) << where(i);
}

TEST_P(Parity, EverySimdTargetGivesTheBitsOfScalar) {
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    std::vector<float> wide(4 * kSamples);
    parity_evaluate_wide(GetParam(), inputs_.data(), kSamples, wide.data());
    for (int i = 0; i < 4 * kSamples; ++i)
      ASSERT_EQ(std::bit_cast<std::uint32_t>(wide[i]), std::bit_cast<std::uint32_t>(scalar_[i]))
          << isa << ": " << where(i) << " = " << wide[i] << ", scalar " << scalar_[i];
  }
}

#ifdef PELAGE_HAS_VULKAN
constexpr std::uint32_t kShader[] = {
#include "parity.comp.inc"
};

struct Gpu {
  vulkan::Device device{{.name = "", .validation = true}};
  vulkan::StorageBuffer inputs{device, kInputs* kSamples * sizeof(float)};
  vulkan::StorageBuffer results{device, 4 * kSamples * sizeof(float)};
  vulkan::Program program{device, kShader, 2, 2 * sizeof(std::uint32_t)};
};

Gpu* gpu() {
  static const std::unique_ptr<Gpu> only = vulkan::devices().empty() ? nullptr : std::make_unique<Gpu>();
  return only.get();
}

TEST_P(Parity, VulkanStaysWithinTheBound) {
  if (!gpu()) GTEST_SKIP() << "no Vulkan device is here; on Debian mesa-vulkan-drivers has one in software";
  std::copy(inputs_.begin(), inputs_.end(), gpu()->inputs.as<float>().begin());
  const std::uint32_t push[] = {static_cast<std::uint32_t>(GetParam()), kSamples};
  vulkan::StorageBuffer* const buffers[] = {&gpu()->inputs, &gpu()->results};
  gpu()->program.run(kSamples / 64, buffers, std::as_bytes(std::span(push)));
  const std::span<const float> results = gpu()->results.as<float>();
  float worst = 0;
  for (int i = 0; i < 4 * kSamples; ++i) {
    const float error = std::fabs(results[i] - scalar_[i]) / std::max(1.0f, std::fabs(scalar_[i]));
    ASSERT_LE(error, test_.bound) << where(i) << " = " << results[i] << ", scalar " << scalar_[i];
    worst = std::max(worst, error);
  }
  EXPECT_TRUE(gpu()->device.complaints().empty()) << gpu()->device.complaints().front();
  std::printf("%s: %.2g of %.2g on %s\n", test_.name.c_str(), worst, test_.bound, gpu()->device.name().c_str());
}
#endif

INSTANTIATE_TEST_SUITE_P(Kernel, Parity, testing::Range(0, static_cast<int>(all_cases().size())),
                         [](const auto& test) { return all_cases()[test.param].name; });

}  // namespace
}  // namespace pelage
