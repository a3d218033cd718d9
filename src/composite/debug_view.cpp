#include "composite/debug_view.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>

#include "core/check.h"
#include "core/parallel.h"
#include "core/rng.h"
#include "frame/segment_lookup.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

float key_depth_of(PixelKey key) { return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32)); }

// Saturated, never dark: strands side by side are told apart, and from the black background.
Vec3 id_color(std::uint32_t groom, std::uint32_t strand) {
  const RandomBits bits = pcg4d(strand, groom, 0x5eed, 0);
  const float hue = 6 * uniform_from_bits(bits.x), value = 0.55f + 0.45f * uniform_from_bits(bits.y);
  const float saturation = 0.45f + 0.45f * uniform_from_bits(bits.z);
  const auto channel = [&](float shift) {
    const float k = std::fmod(hue + shift, 6.f);
    return value * (1 - saturation * std::clamp(std::min(k, 4 - k), 0.f, 1.f));
  };
  return {channel(5), channel(3), channel(1)};
}

// Dark blue to yellow, brightness rising evenly: five stops of the viridis color map (matplotlib, public domain).
Vec3 ramp(float x) {
  static constexpr Vec3 kStops[] = {{0.267f, 0.005f, 0.329f},
                                    {0.230f, 0.322f, 0.546f},
                                    {0.128f, 0.567f, 0.551f},
                                    {0.369f, 0.789f, 0.383f},
                                    {0.993f, 0.906f, 0.144f}};
  const float p = std::clamp(x, 0.f, 1.f) * 4;
  const int i = std::min(3, static_cast<int>(p));
  return lerp(kStops[i], kStops[i + 1], p - static_cast<float>(i));
}

// Strands in gray, thick hairs from the coarsest in red to blue; finer ones than there are colors take the last.
Vec3 level_color(int level) {
  static constexpr Vec3 kStrands{0.75f, 0.75f, 0.75f};
  static constexpr Vec3 kLevels[] = {{0.85f, 0.15f, 0.15f}, {0.95f, 0.55f, 0.1f}, {0.95f, 0.9f, 0.2f},
                                     {0.25f, 0.7f, 0.25f},  {0.15f, 0.7f, 0.8f},  {0.2f, 0.35f, 0.9f}};
  return level < 0 ? kStrands : kLevels[std::min(level, static_cast<int>(std::size(kLevels)) - 1)];
}

Vec3 encoded(Vec3 linear) { return kernel::composite_srgb_encode3(linear); }

// Color of a dense tuft of this strand's hair.
Vec3 albedo(const GroomInstance& groom, const SegmentRef& s) {
  const HairMaterial& m = groom.material;
  const StrandSet& strands = *groom.strands;
  if (m.color_source == HairMaterial::ColorSource::kMelanin)
    return kernel::scatter_tuft_color(kernel::scatter_melanin(m.eumelanin, m.pheomelanin), m.beta_azimuthal);
  if (m.color_source == HairMaterial::ColorSource::kRgb || strands.colors.empty()) return m.color;
  return strands.colors.size() == strands.strand_count() ? strands.colors[s.strand] : strands.colors[strands.offsets[s.strand]];
}

class Painter {
 public:
  Painter(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering, const GBuffer& gbuffer, View what)
      : scene_(scene), view_(view), numbering_(numbering), gbuffer_(gbuffer), what_(what) {
    if (what == View::kDepth) find_depth_range();
    if (what == View::kOverdraw) most_ = std::max(1u, *std::max_element(gbuffer.overdraw.begin(), gbuffer.overdraw.end()));
  }

  struct Paint {
    Vec3 data, display;
    float alpha = 0;
  };

  Paint paint(std::size_t pixel) const {
    if (what_ == View::kCoverage) {
      const float c = analytic_coverage(gbuffer_, pixel);
      return {Vec3(c, c, c), encoded({c, c, c}), c > 0 ? 1.f : 0.f};
    }
    if (what_ == View::kOverdraw) {
      const auto n = static_cast<float>(gbuffer_.overdraw[pixel]);
      return {Vec3(n, n, n), n > 0 ? ramp(std::log2(1 + n) / std::log2(1 + static_cast<float>(most_))) : Vec3(),
              n > 0 ? 1.f : 0.f};
    }
    const PixelKey key = gbuffer_.center[pixel];
    return key == kEmptyPixel ? Paint{} : paint_strand(pixel, key);
  }

 private:
  Paint paint_strand(std::size_t pixel, PixelKey key) const {
    const float depth = key_depth_of(key);
    if (what_ == View::kDepth)
      return {Vec3(depth, depth, depth), ramp((farthest_ - depth) / std::max(1e-9f, farthest_ - nearest_)), 1};
    const SegmentRef s = find_segment(scene_, numbering_, static_cast<std::uint32_t>(key));
    const GroomInstance& groom = scene_.grooms[s.groom];
    if (what_ == View::kStrandId) {
      const auto& ids = groom.strands->strand_id;
      const Vec3 color = id_color(s.groom, ids.empty() ? s.strand : ids[s.strand]);
      return {color, color, 1};
    }
    if (what_ == View::kLod) {
      const int level = groom.sections ? groom.sections->levels[s.strand] : -1;
      const auto data = static_cast<float>(level);
      return {Vec3(data, data, data), level_color(level), 1};
    }
    if (what_ == View::kAlbedo) {
      const Vec3 color = albedo(groom, s);
      return {color, encoded(color), 1};
    }
    const auto width = static_cast<std::size_t>(view_.width);
    const float t = locate_on_segment(scene_, numbering_, view_, s, static_cast<float>(pixel % width) + 0.5f,
                                      static_cast<float>(pixel / width) + 0.5f);
    const StrandSurface surface = surface_at(scene_, numbering_, s, t);
    if (what_ == View::kU) return {Vec3(surface.u, surface.u, surface.u), ramp(surface.u), 1};
    return {surface.tangent, surface.tangent * 0.5f + Vec3(0.5f, 0.5f, 0.5f), 1};
  }

  void find_depth_range() {
    for (const PixelKey key : gbuffer_.center) {
      if (key == kEmptyPixel) continue;
      nearest_ = std::min(nearest_, key_depth_of(key));
      farthest_ = std::max(farthest_, key_depth_of(key));
    }
  }

  const Scene& scene_;
  const CameraView& view_;
  const SegmentNumbering& numbering_;
  const GBuffer& gbuffer_;
  const View what_;
  float nearest_ = INFINITY, farthest_ = 0;
  std::uint32_t most_ = 1;
};

void put(Image& image, std::size_t pixel, Vec3 color, float alpha) {
  float* p = image.pixels.data() + 4 * pixel;
  p[0] = color.x, p[1] = color.y, p[2] = color.z, p[3] = alpha;
}

}  // namespace

DebugView make_debug_view(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering, const GBuffer& gbuffer,
                          View what) {
  PELAGE_CHECK(what != View::kBeauty);
  const std::vector<std::string> channels{"R", "G", "B", "A"};
  DebugView result{Image(view.width, view.height, channels), Image(view.width, view.height, channels)};
  const Painter painter(scene, view, numbering, gbuffer, what);
  parallel_for(gbuffer.center.size(), 4096, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Painter::Paint p = painter.paint(i);
      put(result.data, i, p.data, p.alpha);
      put(result.display, i, p.display, 1);
    }
  });
  return result;
}

}  // namespace pelage
