// From the channels of a file to the colors that are compared.
#include <pelage/error.h>
#include <pelage/io.h>
#include <pelage/render.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "io/byte_source.h"
#include "io/file_kind.h"
#include "core/srgb.h"
#include "metrics/pair.h"

namespace pelage {

Picture read_picture(const std::string& path) {
  const bool png = io::file_kind(io::ByteSource::open(path)).format == "png";
  return {read_image(path, false), png ? Encoding::kDisplay : Encoding::kLinear, path};
}

Picture over_background(Picture picture, Vec3 color) {
  metrics::Colors colors = metrics::colors_of(picture);
  if (colors.alpha.empty()) return picture;
  const bool display = picture.encoding == Encoding::kDisplay;
  const std::array<std::size_t, 4> place = {*metrics::channel(picture.image, "R"), *metrics::channel(picture.image, "G"),
                                            *metrics::channel(picture.image, "B"), *metrics::channel(picture.image, "A")};
  const float behind[] = {color.x, color.y, color.z};
  const std::size_t n = picture.image.channel_count();
  for (std::size_t p = 0; p < colors.alpha.size(); ++p) {
    const float alpha = colors.alpha[p];
    if (alpha == 1) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const float x = colors.rgb.pixels[3 * p + c], rest = (1 - alpha) * behind[c];
      picture.image.pixels[p * n + place[c]] = display ? linear_to_srgb(srgb_to_linear(x) * alpha + rest) : x + rest;
    }
    picture.image.pixels[p * n + place[3]] = 1;
  }
  return picture;
}

namespace metrics {
namespace {

std::size_t pixel_count(const Image& image) {
  return static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

[[noreturn]] void refuse_non_finite(const Picture& picture, std::size_t channel_index) {
  const Image& image = picture.image;
  const std::size_t n = image.channel_count(), width = static_cast<std::size_t>(image.width);
  std::size_t p = 0;
  while (std::isfinite(image.pixels[p * n + channel_index])) ++p;
  const float x = image.pixels[p * n + channel_index];
  throw Error(picture.name, fmt::format("pixel ({}, {})", p % width, p / width),
              fmt::format("channel {} is {}", image.channels[channel_index],
                          std::isnan(x) ? "NaN"
                          : x > 0       ? "+Inf"
                                        : "-Inf"),
              "a picture with values that are no numbers cannot be compared; find what made them");
}

// A channel of every pixel, to every `stride`th number from `to` on.
void take_channel(const Picture& picture, std::size_t channel_index, float* to, std::size_t stride) {
  const std::size_t n = picture.image.channel_count();
  std::atomic<bool> finite = true;
  parallel_for(pixel_count(picture.image), 1 << 14, [&](std::size_t first, std::size_t last) {
    bool all = true;
    for (std::size_t p = first; p < last; ++p) {
      const float x = picture.image.pixels[p * n + channel_index];
      all &= std::isfinite(x);
      to[p * stride] = x;
    }
    if (!all) finite = false;
  });
  if (!finite) refuse_non_finite(picture, channel_index);
}

std::vector<float> take_channel(const Picture& picture, std::size_t channel_index) {
  std::vector<float> values(pixel_count(picture.image));
  take_channel(picture, channel_index, values.data(), 1);
  return values;
}

std::array<std::size_t, 3> color_channels(const Picture& picture) {
  const Image& image = picture.image;
  const auto r = channel(image, "R"), g = channel(image, "G"), b = channel(image, "B");
  if (r && g && b) return {*r, *g, *b};
  if (const auto y = channel(image, "Y")) return {*y, *y, *y};
  if (image.channel_count() == 1) return {0, 0, 0};
  throw Error(picture.name, "", "no channels R, G, B and no single gray channel", "compare pictures, not other layers");
}

void check_whole(const Picture& picture) {
  const Image& image = picture.image;
  if (image.width <= 0 || image.height <= 0 || image.pixels.size() != pixel_count(image) * image.channel_count())
    throw Error(picture.name, "", "an empty image, or one whose pixels do not match its size", "");
}

// In place, color by color of every pixel.
template <class Function>
void for_each_color(Image& rgb, const Function& function) {
  parallel_for(pixel_count(rgb), 4096, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p)
      for (std::size_t c = 0; c < 3; ++c) rgb.pixels[3 * p + c] = function(p, rgb.pixels[3 * p + c]);
  });
}

// What a display shows of a scene-linear picture: straight colors.
Image displayed(const Colors& colors, ToneMap tone_map) {
  Image rgba(colors.rgb.width, colors.rgb.height, {"R", "G", "B", "A"});
  for (std::size_t p = 0; p < pixel_count(rgba); ++p) {
    std::copy_n(colors.rgb.pixels.data() + 3 * p, 3, rgba.pixels.data() + 4 * p);
    rgba.pixels[4 * p + 3] = colors.alpha.empty() ? 1.f : colors.alpha[p];
  }
  const Image display = make_display(rgba, tone_map);
  Image rgb(rgba.width, rgba.height, {"R", "G", "B"});
  for (std::size_t p = 0; p < pixel_count(rgb); ++p) std::copy_n(display.pixels.data() + 4 * p, 3, rgb.pixels.data() + 3 * p);
  return rgb;
}

// Straight, display-encoded colors over black, in linear light.
Image over_black(Image rgb, const std::vector<float>& alpha) {
  if (alpha.empty()) return rgb;
  for_each_color(rgb, [&](std::size_t p, float x) {
    return alpha[p] == 1 ? x : linear_to_srgb(srgb_to_linear(x) * std::clamp(alpha[p], 0.f, 1.f));
  });
  return rgb;
}

}  // namespace

std::optional<std::size_t> channel(const Image& image, const std::string& name) {
  const auto found = std::find(image.channels.begin(), image.channels.end(), name);
  if (found == image.channels.end()) return std::nullopt;
  return static_cast<std::size_t>(found - image.channels.begin());
}

Image decode_display(Image rgb) {
  parallel_for(rgb.pixels.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
    float* x = rgb.pixels.data();
    for (std::size_t i = first; i < last; ++i) x[i] = srgb_to_linear(x[i]);
  });
  return rgb;
}

Colors colors_of(const Picture& picture) {
  check_whole(picture);
  const Image& image = picture.image;
  const std::array<std::size_t, 3> rgb = color_channels(picture);
  Colors colors{Image(image.width, image.height, {"R", "G", "B"}), {}, {}};
  for (std::size_t c = 0; c < 3; ++c) take_channel(picture, rgb[c], colors.rgb.pixels.data() + c, 3);
  if (const auto a = channel(image, "A")) colors.alpha = take_channel(picture, *a);
  const auto coverage = channel(image, "coverage");
  colors.coverage = coverage ? take_channel(picture, *coverage) : colors.alpha;
  return colors;
}

Pair::Pair(const Picture& test, const Picture& reference, const CompareOptions& options)
    : options_(options), test_{test.encoding, colors_of(test), {}, {}}, reference_{
                                                                            reference.encoding, colors_of(reference), {}, {}} {
  const Image &t = test.image, &r = reference.image;
  if (t.width != r.width || t.height != r.height)
    throw Error(test.name, "",
                fmt::format("{} × {} pixels, but {} has {} × {}", t.width, t.height, reference.name, r.width, r.height),
                "compare pictures of the same size");
  const bool linear = test.encoding == Encoding::kLinear && reference.encoding == Encoding::kLinear && !options.tone_map;
  domain_ = linear ? Encoding::kLinear : Encoding::kDisplay;
  tone_map_ = options.tone_map.value_or(ToneMap::kAces);
}

const Image& Pair::in_domain(Side& side, Encoding domain) const {
  const bool linear_pair = domain_ == Encoding::kLinear;
  if (domain == Encoding::kLinear && linear_pair) return side.colors.rgb;  // premultiplied: over black as it is
  if (!side.display)
    side.display =
        over_black(side.encoding == Encoding::kLinear ? displayed(side.colors, tone_map_) : side.colors.rgb, side.colors.alpha);
  if (domain == Encoding::kDisplay) return *side.display;
  if (!side.linear) side.linear = decode_display(*side.display);
  return *side.linear;
}

MetricInput Pair::input(Encoding domain) {
  return {in_domain(test_, domain), in_domain(reference_, domain), domain,
          test_.colors.coverage,    reference_.colors.coverage,    options_};
}

}  // namespace metrics
}  // namespace pelage
