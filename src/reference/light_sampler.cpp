#include "reference/light_sampler.h"

#include <algorithm>
#include <cmath>

#include "frame/environment_map.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

constexpr float kPi = 3.14159265f;
/// Directions that are drawn from the whole sphere, whatever the map says: no direction's density is 0.
constexpr float kFromEverywhere = 0.05f;

float luminance(Vec3 c) { return kernel::v_luminance(max(c, {0, 0, 0})); }

Vec3 uniform_direction(Vec2 u) {
  const float y = 1 - 2 * u.x, r = std::sqrt(std::max(0.f, 1 - y * y)), around = 2 * kPi * u.y;
  return {r * std::cos(around), y, r * std::sin(around)};
}

/// Luminance of a texel and its neighbors, which bilinear look-ups in it see.
double around(const Image& map, int x, int y) {
  double sum = 0;
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, map.height - 1); ++j)
    for (int i = -1; i <= 1; ++i) sum += static_cast<double>(luminance(map_value(map, (x + i + map.width) % map.width, j)));
  return sum / 9;
}

/// Turns `values` into their cumulative share, from 0 to 1; evenly where all are 0. Returns their sum.
double accumulate(const std::vector<double>& values, float* cumulative) {
  double total = 0;
  for (const double v : values) total += v;
  double sum = 0;
  const auto n = static_cast<double>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    cumulative[i] = static_cast<float>(total > 0 ? sum / total : static_cast<double>(i) / n);
    sum += values[i];
  }
  cumulative[values.size()] = 1;
  return total;
}

/// The interval that u falls into, and where in it, 0…1.
std::pair<std::size_t, float> find(const float* cumulative, std::size_t count, float u) {
  const auto i = static_cast<std::size_t>(std::upper_bound(cumulative + 1, cumulative + count, u) - cumulative - 1);
  const float wide = cumulative[i + 1] - cumulative[i];
  return {i, wide > 0 ? std::min((u - cumulative[i]) / wide, 0x1.fffffep-1f) : 0.5f};
}

}  // namespace

EnvironmentSampler::EnvironmentSampler(const Environment& environment) : environment_(environment) {
  const float constant = luminance(environment.radiance);
  black_ = !(constant > 0);
  power_ = 4 * kPi * constant;
  if (black_ || !has_map(environment)) return;
  const Image& map = *environment.map;
  const auto width = static_cast<std::size_t>(map.width), height = static_cast<std::size_t>(map.height);
  rows_.resize(height + 1), columns_.resize(height * (width + 1));
  std::vector<double> row(width), totals(height);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) row[x] = around(map, static_cast<int>(x), static_cast<int>(y));
    const double polar = (static_cast<double>(y) + 0.5) / static_cast<double>(height) * static_cast<double>(kPi);
    totals[y] = accumulate(row, &columns_[y * (width + 1)]) * std::sin(polar);
  }
  const double total = accumulate(totals, rows_.data());
  power_ = constant * static_cast<float>(total * 2 / static_cast<double>(width * height)) * kPi * kPi;
  black_ = !(total > 0);
}

Vec3 EnvironmentSampler::radiance(Vec3 direction) const {
  return max(environment_radiance(environment_, direction), {0, 0, 0});
}

float EnvironmentSampler::map_pdf(Vec2 place) const {
  const std::size_t height = rows_.size() - 1, width = columns_.size() / height - 1;
  const auto cell = [](float t, std::size_t n) { return std::min(static_cast<std::size_t>(t * static_cast<float>(n)), n - 1); };
  const std::size_t x = cell(place.x, width), y = cell(place.y, height);
  const float* row = &columns_[y * (width + 1)];
  const float share = (rows_[y + 1] - rows_[y]) * (row[x + 1] - row[x]);
  const float sine = std::max(std::sin(place.y * kPi), 1e-6f);
  return share * static_cast<float>(width) * static_cast<float>(height) / (2 * kPi * kPi * sine);
}

float EnvironmentSampler::pdf(Vec3 direction) const {
  constexpr float kUniform = 1 / (4 * kPi);
  if (uniform()) return kUniform;
  return kFromEverywhere * kUniform + (1 - kFromEverywhere) * map_pdf(map_place(environment_, direction));
}

Vec3 EnvironmentSampler::sample(Vec2 u) const {
  if (uniform()) return uniform_direction(u);
  if (u.x < kFromEverywhere) return uniform_direction({u.x / kFromEverywhere, u.y});
  const float ux = (u.x - kFromEverywhere) / (1 - kFromEverywhere);
  const std::size_t height = rows_.size() - 1, width = columns_.size() / height - 1;
  const auto [y, in_row] = find(rows_.data(), height, u.y);
  const auto [x, in_column] = find(&columns_[y * (width + 1)], width, ux);
  return map_direction(environment_, (static_cast<float>(x) + in_column) / static_cast<float>(width),
                       (static_cast<float>(y) + in_row) / static_cast<float>(height));
}

std::size_t EnvironmentSampler::bytes() const { return (rows_.capacity() + columns_.capacity()) * sizeof(float); }

LightSampler::LightSampler(const Scene& scene) : environment_(scene.environment) {
  const Bounds box = bounds(scene);
  const float reach = box.empty() ? 1.f : std::max(0.25f * length(box.extent()), 1e-3f);
  cumulative_.push_back(0);
  for (Light light : scene.lights) {
    if (!(luminance(light.intensity) > 0)) continue;
    light.direction = normalize(light.direction);
    float power = luminance(light.intensity);
    if (light.type != Light::Type::kDirectional) {
      const Vec3 nearest = box.empty() ? Vec3() : max(box.lower, min(box.upper, light.position));
      const Vec3 away = light.position - nearest;
      power /= std::max(dot(away, away), reach * reach);
    }
    cumulative_.push_back(cumulative_.back() + power);
    lights_.push_back(light);
  }
}

LightRay LightSampler::toward(std::size_t i, Vec3 p) const {
  const Light& light = lights_[i];
  const Illumination l = illuminate(light, p);
  return {l.to_light, l.distance, l.irradiance, 0, light.casts_shadow};
}

LightRay LightSampler::toward_environment(Vec2 u, float chance) const {
  const Vec3 direction = environment_.sample(u);
  const float pdf = environment_.pdf(direction) * chance;
  return {direction, INFINITY, environment_.radiance(direction) / pdf, pdf, true};
}

LightSampler::Choice LightSampler::choose(float u, bool with_environment) const {
  const float total = cumulative_.back() + (with_environment && !environment_.black() ? environment_.power() : 0.f);
  if (!(total > 0)) return {};
  const float at = u * total;
  if (!(at < cumulative_.back())) {
    if (with_environment && !environment_.black()) return {lights_.size(), environment_.power() / total};
    return {lights_.size() - 1, (cumulative_.back() - cumulative_[lights_.size() - 1]) / total};
  }
  const auto i =
      static_cast<std::size_t>(std::upper_bound(cumulative_.begin() + 1, cumulative_.end(), at) - cumulative_.begin() - 1);
  return {i, (cumulative_[i + 1] - cumulative_[i]) / total};
}

float LightSampler::environment_chance() const {
  return environment_.black() ? 0.f : environment_.power() / (cumulative_.back() + environment_.power());
}

}  // namespace pelage
