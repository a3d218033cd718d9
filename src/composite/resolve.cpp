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

void put(Rgba p, float exposure, float* out) {
  out[0] = p.color.x * exposure, out[1] = p.color.y * exposure, out[2] = p.color.z * exposure;
  out[3] = p.alpha;
}

// The layers of one band and how to read a pixel of them.
class Resolver {
 public:
  explicit Resolver(const FrameLayers& layers)
      : gbuffer_(layers.gbuffer), radiance_(layers.radiance), edges_(layers.edges), opaque_(layers.opaque),
        backdrop_(layers.backdrop), samples_(static_cast<std::size_t>(layers.gbuffer.samples)) {}

  /// Each sample shows its nearest thing; the pixel is their mean.
  Rgba by_samples(std::size_t pixel) const {
    if (opaque_.shade.empty() && !any_hair(pixel)) return backdrop(pixel);
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
    if (opaque_.shade.empty() && !any_hair(pixel) && edges_.index[pixel] == Radiance::kNone) return backdrop(pixel);
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
    return backdrop(pixel);
  }
  Rgba backdrop(std::size_t pixel) const {
    return {backdrop_.pixels.empty() ? backdrop_.color : backdrop_.pixels[pixel], backdrop_.alpha};
  }
  bool any_hair(std::size_t pixel) const {
    const std::uint32_t* first = radiance_.index.data() + pixel * samples_;
    return std::any_of(first, first + samples_, [](std::uint32_t i) { return i != Radiance::kNone; });
  }

  const GBuffer& gbuffer_;
  const Radiance& radiance_;
  const Radiance& edges_;
  const OpaqueLayer& opaque_;
  const Backdrop& backdrop_;
  std::size_t samples_;
};

}  // namespace

Image backdrop_picture(const Backdrop& backdrop, const RenderSettings& settings) {
  Image linear(settings.width, settings.height, {"R", "G", "B", "A"});
  const float exposure = std::exp2(settings.exposure);
  parallel_for(linear.pixels.size() / 4, 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const Vec3 color = backdrop.pixels.empty() ? backdrop.color : backdrop.pixels[p];
      put({color, backdrop.alpha}, exposure, &linear.pixels[4 * p]);
    }
  });
  return linear;
}

void resolve(const FrameLayers& layers, const RenderSettings& settings, int x, int y, Image& linear) {
  const GBuffer& gbuffer = layers.gbuffer;
  const auto width = static_cast<std::size_t>(gbuffer.width), height = static_cast<std::size_t>(gbuffer.height);
  PELAGE_CHECK_EQ(linear.channel_count(), 4u);
  PELAGE_CHECK_LE(x + gbuffer.width, linear.width);
  PELAGE_CHECK_LE(y + gbuffer.height, linear.height);
  PELAGE_CHECK_EQ(layers.radiance.index.size(), width * height * static_cast<std::size_t>(gbuffer.samples));
  const bool analytic = settings.alpha == AlphaSource::kAnalytic;
  if (analytic) {
    PELAGE_CHECK_EQ(gbuffer.coverage.size(), width * height);
    PELAGE_CHECK_EQ(layers.edges.index.size(), width * height);
  }
  const Resolver resolver(layers);
  const float exposure = std::exp2(settings.exposure);
  parallel_for(height, 8, [&](std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      float* out = linear.at(x, y + static_cast<int>(row));
      for (std::size_t pixel = row * width; pixel < (row + 1) * width; ++pixel, out += 4)
        put(analytic ? resolver.by_area(pixel) : resolver.by_samples(pixel), exposure, out);
    }
  });
}

}  // namespace pelage
