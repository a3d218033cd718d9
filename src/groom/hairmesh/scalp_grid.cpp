#include "groom/hairmesh/scalp_grid.h"

#include <map>
#include <tuple>

#include "groom/head_shape.h"
#include "groom/scalp.h"
#include "groom/sdf.h"

namespace pelage::groom {
namespace {

constexpr float kPi = 3.14159265f;
constexpr float kTemple = 0.72f, kNapeCorner = 2.42f;  // azimuths of a patch's corners on the hairline
constexpr float kAboveHairline = 0.003f;               // metres: the rim of the grid is chords of a curve
constexpr float kRootLift = 0.0015f;                   // metres: so that quads cut the skin instead of lying below it
constexpr float kWhorlX = -0.010f;                     // where the middle line passes over the crown
constexpr float kCrown = 0.40f;                        // how far along

/// Skin on the hairline at a signed azimuth, positive to the left.
Vec3 hairline(float azimuth) {
  const float y = hairline_height(std::abs(azimuth)) + kAboveHairline;
  return skin_along(kHeadAxis + Vec3(0, y, 0), {std::sin(azimuth), 0, std::cos(azimuth)});
}

class GridMaker {
 public:
  explicit GridMaker(const ScalpGridSettings& settings) : s_(settings) {
    // The forehead's end of the middle line: where the hairline has its x.
    front_azimuth_ = std::asin(s_.parting_x / 0.087f);
    crown_row_ = static_cast<int>(std::lround(kCrown * static_cast<float>(s_.rows)));
    for (const int side : {1, -1})
      for (int i = 0; i < s_.rows; ++i)
        for (int j = 0; j < s_.across; ++j) add_quad(side, i, j);
  }
  ScalpGrid grid;

 private:
  Vec3 middle(float along) const {
    const Vec3 front = hairline(front_azimuth_), back = hairline(kPi);
    const auto elevation = [](Vec3 p) { return std::atan2(p.y - kSkullCenter.y, p.z - kSkullCenter.z); };
    const float first = elevation(front), last = elevation(back) + (elevation(back) < 0 ? 2 * kPi : 0);
    const float angle = mix(first, last, along);
    const float crown_x = kWhorlX * (s_.parted ? 1.f : 0.f) + 0.5f * s_.parting_x;
    const float x =
        along < kCrown ? mix(front.x, crown_x, smoothstep(0, kCrown, along)) : mix(crown_x, 0, smoothstep(kCrown, 1, along));
    return skin_along({x, kSkullCenter.y, kSkullCenter.z}, {0, std::sin(angle), std::cos(angle)});
  }

  /// A Coons patch between the four curves, drawn out to the skin.
  Vec3 place(int side, float along, float down) const {
    const auto sided = [side](float azimuth) { return hairline(static_cast<float>(side) * azimuth); };
    const auto forehead = [&](float d) { return hairline(mix(front_azimuth_, static_cast<float>(side) * kTemple, d)); };
    const auto nape = [&](float d) { return sided(mix(kPi, kNapeCorner, d)); };
    const Vec3 edge = sided(mix(kTemple, kNapeCorner, along));
    const Vec3 ruled_down = lerp(middle(along), edge, down), ruled_along = lerp(forehead(down), nape(down), along);
    const Vec3 corners = lerp(lerp(forehead(0), nape(0), along), lerp(forehead(1), nape(1), along), down);
    if (down == 1) return edge;
    if (down == 0) return middle(along);
    return skin_along(kSkullCenter, normalize(ruled_down + ruled_along - corners - kSkullCenter));
  }

  std::uint32_t column(int side, int i, int j, bool behind, int quad) {
    const bool doubled = s_.divided && i == crown_row_;
    const bool in_parting = s_.parted && j == 0 && (i < crown_row_ || (doubled && !behind));
    const int own_side = in_parting || j > 0 ? side : 0;
    const auto key = std::tuple(i, j, own_side, doubled && behind, s_.separate ? quad : 0);
    const auto [found, is_new] = columns_.try_emplace(key, static_cast<std::uint32_t>(grid.columns.size()));
    if (is_new) {
      ScalpColumn c;
      c.along = static_cast<float>(i) / static_cast<float>(s_.rows);
      c.down = static_cast<float>(j) / static_cast<float>(s_.across);
      c.side = in_parting ? side : 0;
      c.behind = behind;
      c.root = place(side, c.along, c.down);
      c.normal = head_normal(c.root);
      if (c.down < 1) c.root += c.normal * kRootLift;
      grid.columns.push_back(c);
    }
    return found->second;
  }

  void add_quad(int side, int i, int j) {
    const bool behind = i >= crown_row_;
    const int quad = static_cast<int>(grid.quads.size());
    const auto corner = [&](int di, int dj) { return column(side, i + di, j + dj, behind, quad); };
    grid.quads.push_back({corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)});
  }

  ScalpGridSettings s_;
  float front_azimuth_ = 0;
  int crown_row_ = 0;
  std::map<std::tuple<int, int, int, bool, int>, std::uint32_t> columns_;
};

}  // namespace

Vec3 skin_along(Vec3 from, Vec3 direction) {
  // The head is star-shaped enough that the last crossing of a few halvings is the skin.
  float inside = 0, outside = 0.2f;
  for (int i = 0; i < 24; ++i) {
    const float middle = 0.5f * (inside + outside);
    (head_distance(from + direction * middle) < 0 ? inside : outside) = middle;
  }
  return from + direction * inside;
}

ScalpGrid make_scalp_grid(const ScalpGridSettings& settings) { return GridMaker(settings).grid; }

}  // namespace pelage::groom
