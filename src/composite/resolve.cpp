#include <algorithm>
#include <cmath>

#include "composite/composite.h"
#include "core/check.h"
#include "core/parallel.h"

namespace pelage {
namespace {

struct Rgba {
  Vec3 color;  // premultiplied
  float alpha = 0;
};

Rgba over(Rgba front, Rgba back) {
  return {front.color + back.color * (1 - front.alpha), front.alpha + back.alpha * (1 - front.alpha)};
}

// The layers of one band and how to read a pixel of them.
class Resolver {
 public:
  explicit Resolver(const FrameLayers& layers)
      : gbuffer_(layers.gbuffer), radiance_(layers.radiance), edges_(layers.edges), opaque_(layers.opaque),
        backdrop_(layers.backdrop), samples_(static_cast<std::size_t>(layers.gbuffer.samples)) {}

  /// Each sample shows its nearest thing; the pixel is their mean.
  Rgba by_samples(std::size_t pixel) const {
    Rgba sum;
    for (std::size_t s = pixel * samples_; s < (pixel + 1) * samples_; ++s) {
      const std::uint32_t hair = radiance_.index[s];
      const Rgba seen = hair != Radiance::kNone ? Rgba{radiance_.color[hair], 1} : behind_hair(pixel, s);
      sum.color += seen.color;
      sum.alpha += seen.alpha;
    }
    return mean(sum);
  }

  /// Hair covers exactly its area; what shows through is the mean of what is behind it.
  Rgba by_area(std::size_t pixel) const {
    Rgba back;
    Vec3 hair;
    std::size_t hits = 0;
    for (std::size_t s = pixel * samples_; s < (pixel + 1) * samples_; ++s) {
      const Rgba seen = behind_hair(pixel, s);
      back.color += seen.color;
      back.alpha += seen.alpha;
      if (const std::uint32_t i = radiance_.index[s]; i != Radiance::kNone) hair += radiance_.color[i], ++hits;
    }
    if (!hits && edges_.index[pixel] != Radiance::kNone) hair = edges_.color[edges_.index[pixel]], hits = 1;
    if (!hits) return mean(back);
    const float area = analytic_coverage(gbuffer_, pixel);
    return over({hair * (area / static_cast<float>(hits)), area}, mean(back));
  }

 private:
  Rgba mean(Rgba sum) const {
    const float share = 1 / static_cast<float>(samples_);
    return {sum.color * share, sum.alpha * share};
  }
  Rgba behind_hair(std::size_t pixel, std::size_t sample) const {
    if (!opaque_.shade.empty() && opaque_.shade[sample] != OpaqueLayer::kNone) return {opaque_color(opaque_, sample), 1};
    return {backdrop_.pixels.empty() ? backdrop_.color : backdrop_.pixels[pixel], backdrop_.alpha};
  }

  const GBuffer& gbuffer_;
  const Radiance& radiance_;
  const Radiance& edges_;
  const OpaqueLayer& opaque_;
  const Backdrop& backdrop_;
  std::size_t samples_;
};

}  // namespace

void resolve(const FrameLayers& layers, const RenderSettings& settings, int first_row, Image& linear) {
  const GBuffer& gbuffer = layers.gbuffer;
  const auto width = static_cast<std::size_t>(gbuffer.width), height = static_cast<std::size_t>(gbuffer.height);
  PELAGE_CHECK_EQ(linear.channel_count(), 4u);
  PELAGE_CHECK_EQ(linear.width, gbuffer.width);
  PELAGE_CHECK_LE(first_row + gbuffer.height, linear.height);
  PELAGE_CHECK_EQ(layers.radiance.index.size(), width * height * static_cast<std::size_t>(gbuffer.samples));
  const bool analytic = settings.alpha == AlphaSource::kAnalytic;
  if (analytic) {
    PELAGE_CHECK_EQ(gbuffer.coverage.size(), width * height);
    PELAGE_CHECK_EQ(layers.edges.index.size(), width * height);
  }
  const Resolver resolver(layers);
  const float exposure = std::exp2(settings.exposure);
  parallel_for(height, 8, [&](std::size_t first, std::size_t last) {
    for (std::size_t y = first; y < last; ++y) {
      float* out = linear.at(0, first_row + static_cast<int>(y));
      for (std::size_t pixel = y * width; pixel < (y + 1) * width; ++pixel, out += 4) {
        const Rgba p = analytic ? resolver.by_area(pixel) : resolver.by_samples(pixel);
        out[0] = p.color.x * exposure, out[1] = p.color.y * exposure, out[2] = p.color.z * exposure;
        out[3] = p.alpha;
      }
    }
  });
}

}  // namespace pelage
