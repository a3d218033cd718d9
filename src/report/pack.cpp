#include "report/pack.h"

#include <half.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace pelage::report {
namespace {

constexpr float kMostHalf = 65504;

std::vector<std::uint8_t> deflated(const std::vector<std::uint8_t>& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::vector<std::uint8_t> out(size);
  PELAGE_CHECK_EQ(compress2(out.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), Z_DEFAULT_COMPRESSION), Z_OK);
  out.resize(size);
  return out;
}

std::vector<std::uint16_t> halves(const std::vector<float>& values) {
  std::vector<std::uint16_t> out(values.size());
  std::transform(values.begin(), values.end(), out.begin(),
                 [](float x) { return half(std::clamp(x, -kMostHalf, kMostHalf)).bits(); });
  return out;
}

}  // namespace

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string pack_halves(const Image& image) {
  const std::size_t channels = image.channel_count(), pixels = image.pixels.size() / channels;
  const std::vector<std::uint16_t> values = halves(image.pixels);
  std::vector<std::uint8_t> bytes(2 * values.size());
  std::uint16_t before = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint16_t value = values[i % pixels * channels + i / pixels];
    const auto difference = static_cast<std::uint16_t>(value - before);
    bytes[i] = static_cast<std::uint8_t>(difference >> 8);
    bytes[i + values.size()] = static_cast<std::uint8_t>(difference);
    before = value;
  }
  return base64(deflated(bytes));
}

std::string pack_bytes(const Image& image) {
  std::vector<std::uint8_t> bytes(image.pixels.size());
  std::uint8_t before = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto value = static_cast<std::uint8_t>(std::lround(255 * std::clamp(image.pixels[i], 0.f, 1.f)));
    bytes[i] = static_cast<std::uint8_t>(value - before);
    before = value;
  }
  return base64(deflated(bytes));
}

}  // namespace pelage::report
