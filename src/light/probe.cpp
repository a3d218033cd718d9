#include "light/probe.h"

#include <vector>

#include "core/check.h"
#include "core/parallel.h"
#include "frame/environment_map.h"
#include "kernel/scalar.h"
#include "light/environment.h"

namespace pelage {
namespace {

const std::size_t kLevels = static_cast<std::size_t>(kernel::kProbeLevels);
const std::size_t kRow = static_cast<std::size_t>(kernel::kProbeSide) + 2, kPlane = kRow * kRow;

/// The sky as lines of numbers, which the sums of prefiltering run along.
struct SkyLines {
  std::vector<float> x, y, z, solid_angle, r, g, b;

  explicit SkyLines(const std::vector<SkyTexel>& texels) {
    for (const SkyTexel& t : texels) {
      x.push_back(t.direction.x), y.push_back(t.direction.y), z.push_back(t.direction.z);
      solid_angle.push_back(t.solid_angle);
      r.push_back(t.power.x), g.push_back(t.power.y), b.push_back(t.power.z);
    }
  }
};

Vec3 blurred(const SkyLines& sky, Vec3 d, float alpha) {
  float weight = 0, r = 0, g = 0, b = 0;
  for (std::size_t i = 0; i < sky.x.size(); ++i) {
    const float w = kernel::light_ggx_lobe(alpha, d.x * sky.x[i] + d.y * sky.y[i] + d.z * sky.z[i]);
    weight += w * sky.solid_angle[i], r += w * sky.r[i], g += w * sky.g[i], b += w * sky.b[i];
  }
  return Vec3(r, g, b) / weight;
}

/// Direction of a texel's center, the frame's included.
Vec3 texel_direction(std::size_t texel) {
  const auto at = [](std::size_t i) { return (static_cast<float>(i) - 0.5f) / kernel::kProbeSide; };
  return kernel::light_octahedral_direction({at(texel % kRow), at(texel / kRow)});
}

}  // namespace

EnvironmentProbe make_probe(const Environment& environment) {
  EnvironmentProbe probe;
  probe.texels.resize(kLevels * 3 * kPlane);
  const auto put = [&](std::size_t level, std::size_t texel, Vec3 radiance) {
    float* at = probe.texels.data() + level * 3 * kPlane + texel;
    at[0] = radiance.x, at[kPlane] = radiance.y, at[2 * kPlane] = radiance.z;
  };
  if (!has_map(environment)) {
    for (std::size_t i = 0; i < kLevels * kPlane; ++i) put(i / kPlane, i % kPlane, max(environment.radiance, {0, 0, 0}));
    return probe;
  }
  const SkyLines sky(sky_texels(environment));
  parallel_for(kLevels * kPlane, kRow, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t level = i / kPlane, texel = i % kPlane;
      put(level, texel, blurred(sky, texel_direction(texel), kernel::light_probe_alpha(static_cast<float>(level))));
    }
  });
  return probe;
}

Vec3 probe_radiance(const EnvironmentProbe& probe, Vec3 d, float alpha) {
  PELAGE_CHECK_EQ(probe.texels.size(), kLevels * 3 * kPlane);
  const kernel::LightProbeCell c = kernel::light_probe_cell(d, alpha);
  const auto channel = [&](std::size_t level, std::size_t plane) {
    const float* v = probe.texels.data() + (level * 3 + plane) * kPlane + static_cast<std::size_t>(c.y) * kRow +
                     static_cast<std::size_t>(c.x);
    return kernel::light_probe_mix(c, v[0], v[1], v[kRow], v[kRow + 1]);
  };
  const auto level = [&](std::size_t k) { return Vec3(channel(k, 0), channel(k, 1), channel(k, 2)); };
  const std::size_t k = static_cast<std::size_t>(c.level);
  return level(k) * c.sharper + level(k + 1) * (1 - c.sharper);
}

}  // namespace pelage
