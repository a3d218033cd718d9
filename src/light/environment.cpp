#include "light/environment.h"

#include <algorithm>
#include <cmath>

#include "frame/environment_map.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

constexpr float kPi = 3.14159265f;
/// The map is averaged down to this before anything is derived from it: pieces and harmonics need no more.
constexpr int kWidth = 128, kHeight = 64;

float luminance(Vec3 c) { return kernel::v_luminance(c); }

/// Mean of the map over columns [x0, x1) and rows [y0, y1), at least one texel.
Vec3 map_mean(const Image& map, int x0, int x1, int y0, int y1) {
  x1 = std::max(x1, x0 + 1), y1 = std::max(y1, y0 + 1);
  Vec3 sum;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) sum += map_value(map, x, y);
  return sum / static_cast<float>((x1 - x0) * (y1 - y0));
}

}  // namespace

std::vector<SkyTexel> sky_texels(const Environment& environment) {
  std::vector<SkyTexel> texels;
  texels.reserve(kWidth * kHeight);
  for (int y = 0; y < kHeight; ++y) {
    const float top = static_cast<float>(y) / kHeight * kPi, bottom = static_cast<float>(y + 1) / kHeight * kPi;
    const float solid_angle = 2 * kPi / kWidth * (std::cos(top) - std::cos(bottom));
    for (int x = 0; x < kWidth; ++x) {
      Vec3 radiance = environment.radiance;
      if (has_map(environment)) {
        const Image& map = *environment.map;
        radiance = radiance * map_mean(map, x * map.width / kWidth, (x + 1) * map.width / kWidth, y * map.height / kHeight,
                                       (y + 1) * map.height / kHeight);
      }
      const Vec3 power = max(radiance, {0, 0, 0}) * solid_angle;
      const Vec3 d =
          map_direction(environment, (static_cast<float>(x) + 0.5f) / kWidth, (static_cast<float>(y) + 0.5f) / kHeight);
      texels.push_back({d, power, luminance(power), solid_angle});
    }
  }
  return texels;
}

namespace {

/// Texels [x0, x1) × [y0, y1) of the reduced map.
struct Region {
  int x0, x1, y0, y1;
};

template <class Body>
void for_each_texel(const std::vector<SkyTexel>& texels, const Region& r, const Body& body) {
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) body(texels[static_cast<std::size_t>(y * kWidth + x)], x, y);
}

/// Splits across the longer side (columns shrink toward the poles) where both halves have the same power.
std::pair<Region, Region> split(const std::vector<SkyTexel>& texels, const Region& r) {
  const float row = (static_cast<float>(r.y0 + r.y1) * 0.5f) / kHeight * kPi;
  const bool columns = static_cast<float>(r.x1 - r.x0) * std::sin(row) > static_cast<float>(r.y1 - r.y0);
  const int from = columns ? r.x0 : r.y0, to = columns ? r.x1 : r.y1;
  std::vector<double> line(static_cast<std::size_t>(to - from));
  double total = 0;
  for_each_texel(texels, r, [&](const SkyTexel& t, int x, int y) {
    line[static_cast<std::size_t>((columns ? x : y) - from)] += static_cast<double>(t.luminance);
    total += static_cast<double>(t.luminance);
  });
  int cut = from + 1;
  for (double sum = line[0]; cut + 1 < to; ++cut) {
    const double next = line[static_cast<std::size_t>(cut - from)];
    if (sum + 0.5 * next >= 0.5 * total) break;
    sum += next;
  }
  return columns ? std::pair{Region{r.x0, cut, r.y0, r.y1}, Region{cut, r.x1, r.y0, r.y1}}
                 : std::pair{Region{r.x0, r.x1, r.y0, cut}, Region{r.x0, r.x1, cut, r.y1}};
}

/// Mean direction and spread of a region. Directions about an axis with a standard deviation σ on each of two axes have
/// a mean of length 1 − σ² to first order.
EnvironmentPiece summarize(const std::vector<SkyTexel>& texels, const Region& r) {
  Vec3 mean, power;
  float weight = 0;
  for_each_texel(texels, r, [&](const SkyTexel& t, int, int) {
    mean += t.direction * t.luminance, power += t.power, weight += t.luminance;
  });
  if (!(weight > 0)) return {{0, 1, 0}, {0, 0, 0}, 0};
  const float resultant = length(mean) / weight;
  return {normalize(mean), power, std::sqrt(std::max(0.f, 1 - resultant))};
}

}  // namespace

std::vector<EnvironmentPiece> cut_environment(const Environment& environment, int levels) {
  if (!(luminance(environment.radiance) > 0)) return {};
  const std::vector<SkyTexel> texels = sky_texels(environment);
  std::vector<Region> regions{{0, kWidth, 0, kHeight}};
  for (int level = 0; level < levels; ++level) {
    std::vector<Region> halves;
    for (const Region& r : regions) {
      if (r.x1 - r.x0 < 2 && r.y1 - r.y0 < 2) {
        halves.push_back(r);
        continue;
      }
      const auto [a, b] = split(texels, r);
      halves.push_back(a), halves.push_back(b);
    }
    regions = std::move(halves);
  }
  std::vector<EnvironmentPiece> pieces;
  for (const Region& r : regions) {
    const EnvironmentPiece piece = summarize(texels, r);
    if (luminance(piece.irradiance) > 0) pieces.push_back(piece);
  }
  return pieces;
}

std::array<Vec3, 9> irradiance_harmonics(const Environment& environment) {
  std::array<Vec3, 9> c{};
  for (const SkyTexel& t : sky_texels(environment)) {
    const kernel::LightHarmonics h = kernel::light_harmonics(t.direction);
    const float y[9] = {h.c00, h.c1n, h.c10, h.c1p, h.c2nn, h.c2n, h.c20, h.c2p, h.c2pp};
    for (std::size_t i = 0; i < 9; ++i) {
      const float band = i == 0 ? kernel::kLightCosineBand0 : i < 4 ? kernel::kLightCosineBand1 : kernel::kLightCosineBand2;
      c[i] += t.power * (y[i] * band);
    }
  }
  return c;
}

}  // namespace pelage
