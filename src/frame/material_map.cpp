#include "frame/material_map.h"

#include <limits>

namespace pelage {
namespace {

constexpr float kDegree = 3.14159265f / 180;

/// The first channel; comparisons that NaN fails.
float texel_value(const float* texel) { return texel[0] > 0 ? std::min(texel[0], kMostFinish) : 0.f; }

float value_at(const std::shared_ptr<const Image>& map, float x, float y) {
  return map ? texel_value(map_texel(*map, x, y)) : 1.f;
}

/// Values of the first `rows` rows of a map, increasing, each once: all of them where they are no more than `most`, else the least
/// and the largest at least. {1} without a map.
std::vector<float> values_of(const std::shared_ptr<const Image>& map, int rows, std::size_t most) {
  if (!map) return {1};
  std::vector<float> values;
  for (int y = 0; y < std::min(rows, map->height); ++y)
    for (int x = 0; x < map->width; ++x) {
      const float value = texel_value(map->at(x, y));
      const auto place = std::lower_bound(values.begin(), values.end(), value);
      if (place != values.end() && *place == value) continue;
      values.insert(place, value);
      if (values.size() > most + 2) values.erase(values.begin() + 1);  // neither the least nor the largest
    }
  return values;
}

}  // namespace

Finish mapped_finish(const GroomInstance& groom, GroomPlace at) {
  return {value_at(groom.roughness_map, at.u, at.v) * value_at(groom.roughness_along, at.w, 0),
          value_at(groom.tilt_map, at.u, at.v) * value_at(groom.tilt_along, at.w, 0)};
}

HairMaterial finished(HairMaterial m, Finish f) {
  m.beta_longitudinal = std::clamp(m.beta_longitudinal * f.roughness, 0.5f * kDegree, 60 * kDegree);
  m.beta_azimuthal = std::clamp(m.beta_azimuthal * f.roughness, 0.5f * kDegree, 90 * kDegree);
  m.cuticle_tilt = std::clamp(m.cuticle_tilt * f.tilt, 0.f, 15 * kDegree);
  return m;
}

RoughnessLevels::RoughnessLevels(const GroomInstance& groom) {
  const std::vector<float> across = values_of(groom.roughness_map, std::numeric_limits<int>::max(), kMost),
                           along = values_of(groom.roughness_along, 1, kMost);
  values_.clear();
  for (const float a : across)
    for (const float b : along) values_.push_back(a * b);
  std::sort(values_.begin(), values_.end());
  values_.erase(std::unique(values_.begin(), values_.end()), values_.end());
  if (values_.size() <= kMost) return;
  const float least = values_.front(), step = (values_.back() - least) / (kMost - 1);
  values_.clear();
  for (std::size_t i = 0; i < kMost; ++i) values_.push_back(least + static_cast<float>(i) * step);
}

std::size_t RoughnessLevels::nearest(float roughness) const {
  const auto above = std::lower_bound(values_.begin(), values_.end(), roughness);
  if (above == values_.begin()) return 0;
  const auto i = static_cast<std::size_t>(above - values_.begin());
  if (above == values_.end() || roughness - values_[i - 1] < values_[i] - roughness) return i - 1;
  return i;
}

}  // namespace pelage
