// Which pixels count: hair, an explicit mask, tiles.
#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>

#include "metrics/pair.h"

namespace pelage {
namespace {

using metrics::channel;

constexpr const char* kNoHairRemedy =
    "render the reference with `--layers coverage` to EXR, or give a mask image: white where pixels count";

// 1 where any of `channels` is above 0.
PixelMask above_zero(const Image& image, const std::vector<std::size_t>& channels) {
  const std::size_t n = image.channel_count();
  PixelMask mask(image.pixels.size() / n);
  for (std::size_t p = 0; p < mask.size(); ++p)
    mask[p] = std::any_of(channels.begin(), channels.end(), [&](std::size_t c) { return image.pixels[p * n + c] > 0; });
  return mask;
}

bool any(const PixelMask& mask) {
  return std::any_of(mask.begin(), mask.end(), [](std::uint8_t m) { return m != 0; });
}
bool all(const PixelMask& mask) {
  return std::all_of(mask.begin(), mask.end(), [](std::uint8_t m) { return m != 0; });
}

std::vector<std::size_t> present(const Image& image, std::initializer_list<const char*> names) {
  std::vector<std::size_t> found;
  for (const char* name : names)
    if (const auto c = channel(image, name)) found.push_back(*c);
  return found;
}

PixelMask hair_or_error(const Picture& picture, PixelMask mask, const char* channels) {
  if (any(mask)) return mask;
  throw Error(picture.name, channels, "no pixel shows hair", kNoHairRemedy);
}

}  // namespace

PixelMask hair_mask(const Picture& picture, std::string* note) {
  const Image& image = picture.image;
  if (const auto c = present(image, {"coverage"}); !c.empty()) return hair_or_error(picture, above_zero(image, c), "coverage");
  if (const auto c = present(image, {"id.R", "id.G", "id.B"}); !c.empty())
    return hair_or_error(picture, above_zero(image, c), "id");
  if (const auto c = present(image, {"strand"}); !c.empty()) return hair_or_error(picture, above_zero(image, c), "strand");
  const auto alpha = present(image, {"A"});
  if (alpha.empty())
    throw Error(picture.name, "", "no channel `coverage`, `id.R`, `strand` or `A` says where hair is", kNoHairRemedy);
  PixelMask mask = above_zero(image, alpha);
  // An opaque picture has alpha 1 everywhere, which says nothing about hair.
  if (all(mask)) throw Error(picture.name, "A", "alpha is above 0 everywhere, so it does not say where hair is", kNoHairRemedy);
  if (note) *note = fmt::format("{}: hair is where alpha is above 0, which counts meshes too", picture.name);
  return hair_or_error(picture, std::move(mask), "A");
}

PixelMask flyaway_mask(const Picture& picture, float most_coverage) {
  const Image& image = picture.image;
  const auto c = channel(image, "coverage");
  if (!c) throw Error(picture.name, "", "no channel `coverage` says where hair is thin", "render it with `--layers coverage`");
  const std::size_t n = image.channel_count();
  PixelMask mask(image.pixels.size() / n);
  for (std::size_t p = 0; p < mask.size(); ++p) {
    const float covered = image.pixels[p * n + *c];
    mask[p] = covered > 0 && covered < most_coverage;
  }
  if (any(mask)) return mask;
  throw Error(picture.name, "coverage", fmt::format("no pixel has hair that covers less than {} of it", most_coverage), "");
}

PixelMask mask_from_image(const Picture& picture) {
  std::vector<std::size_t> colors;
  for (std::size_t c = 0; c < picture.image.channel_count(); ++c)
    if (picture.image.channels[c] != "A") colors.push_back(c);
  PixelMask mask = above_zero(picture.image, colors);
  if (!any(mask)) throw Error(picture.name, "", "the mask is black everywhere", "make it white where pixels count");
  return mask;
}

std::vector<Region> tile_regions(int width, int height, int columns, int rows) {
  if (columns < 1 || rows < 1 || columns > width || rows > height)
    throw Error("regions", fmt::format("{}x{}", columns, rows),
                fmt::format("a picture of {} × {} pixels has no such tiles", width, height), "use fewer tiles");
  std::vector<Region> regions;
  const auto edge = [](int size, int parts, int i) { return static_cast<int>(static_cast<std::int64_t>(size) * i / parts); };
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const int x0 = edge(width, columns, x), y0 = edge(height, rows, y);
      regions.push_back(
          {fmt::format("{},{}", x, y), {x0, y0, edge(width, columns, x + 1) - x0, edge(height, rows, y + 1) - y0}});
    }
  return regions;
}

}  // namespace pelage
