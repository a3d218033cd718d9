// Radiance pictures: three mantissas that share an exponent, in runs (G. Ward, Graphics Gems II, chapter II.5;
// references.bib: Ward1991Pixels).
#include <fmt/format.h>
#include <pelage/error.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "io/image_formats.h"

namespace pelage::io {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;
// Rows of other widths are not written in runs: their first bytes could not be told from a pixel's.
constexpr int kShortestRunRow = 8, kLongestRunRow = 0x7fff;
constexpr std::size_t kShortestRun = 4, kLongestRun = 127, kLongestDump = 128;

bool in_runs(int width) { return width >= kShortestRunRow && width <= kLongestRunRow; }

Rgbe pack(const float* rgb) {
  constexpr float kSmallest = 1e-32f, kLargest = 0x1p127f;
  float largest = 0;
  for (std::size_t c = 0; c < 3; ++c) largest = std::max(largest, rgb[c]);
  if (largest < kSmallest) return {0, 0, 0, 0};
  int exponent;
  std::frexp(std::min(largest, kLargest * (1 - 0x1p-24f)), &exponent);
  const float scale = std::ldexp(1.f, 8 - exponent);
  const auto mantissa = [&](float x) {
    return x > 0 ? static_cast<std::uint8_t>(std::min(x * scale, 255.f)) : std::uint8_t{0};
  };
  return {mantissa(rgb[0]), mantissa(rgb[1]), mantissa(rgb[2]), static_cast<std::uint8_t>(exponent + 128)};
}

void unpack(const Rgbe& pixel, float exposure, float* rgb) {
  const float scale = pixel[3] == 0 ? 0 : std::ldexp(1.f, pixel[3] - (128 + 8)) / exposure;
  for (std::size_t c = 0; c < 3; ++c) rgb[c] = static_cast<float>(pixel[c]) * scale;
}

class HdrReader {
 public:
  explicit HdrReader(const ByteSource& source) : source_(source), bytes_(source.read_all()) {}

  Image read() {
    read_header();
    check_image_size(source_, width_, height_, 3);
    Image image(width_, height_, {"R", "G", "B"});
    std::vector<Rgbe> row(static_cast<std::size_t>(width_));
    for (int y = 0; y < height_; ++y) {
      read_row(row);
      for (int x = 0; x < width_; ++x) unpack(row[static_cast<std::size_t>(x)], exposure_, image.at(x, y));
    }
    return image;
  }

 private:
  void read_header() {
    for (std::string_view text = line(); !text.empty(); text = line()) {
      if (text.starts_with("FORMAT=") && text != "FORMAT=32-bit_rle_rgbe") fail(std::string(text), "only RGBE is read");
      if (text.starts_with("EXPOSURE=")) exposure_ *= number<float>(text.substr(9));  // settings multiply
    }
    if (!(exposure_ > 0) || !std::isfinite(exposure_)) fail("an exposure that is not positive", "");
    std::string_view size = line();  // "-Y height +X width"
    if (!size.starts_with("-Y ")) fail(std::string(size), "only rows from top to bottom are read");
    size.remove_prefix(3);
    const std::size_t gap = size.find(" +X ");
    if (gap == std::string_view::npos) fail(std::string(size), "only rows from left to right are read");
    height_ = number<int>(size.substr(0, gap)), width_ = number<int>(size.substr(gap + 4));
  }

  void read_row(std::vector<Rgbe>& row) {
    const Rgbe start = pixel();
    const bool runs = in_runs(width_) && start[0] == 2 && start[1] == 2 && (start[2] << 8 | start[3]) == width_;
    if (runs) read_runs(row);
    else read_repeated(row, start);
  }

  // Each of the four components by itself: a count above 128 announces that many less 128 equal values, else that many values.
  void read_runs(std::vector<Rgbe>& row) {
    for (std::size_t c = 0; c < 4; ++c)
      for (std::size_t x = 0; x < row.size();) {
        const std::size_t code = byte(), count = code > 128 ? code - 128 : code;
        if (count == 0 || count > row.size() - x) fail("a run over the end of its row", "the file is damaged");
        const std::uint8_t repeated = code > 128 ? byte() : std::uint8_t{0};
        for (const std::size_t end = x + count; x < end; ++x) row[x][c] = code > 128 ? repeated : byte();
      }
  }

  // The older way: whole pixels; (1, 1, 1, n) repeats the one before n times, and the next such one n · 256 times more.
  void read_repeated(std::vector<Rgbe>& row, Rgbe next) {
    unsigned shift = 0;
    for (std::size_t x = 0; x < row.size();) {
      if (next[0] == 1 && next[1] == 1 && next[2] == 1) {
        const std::size_t count = shift < 24 ? std::size_t{next[3]} << shift : SIZE_MAX;
        if (x == 0 || count > row.size() - x) fail("a run over the end of its row", "the file is damaged");
        std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(x), count, row[x - 1]);
        x += count, shift += 8;
      } else {
        row[x++] = next, shift = 0;
      }
      if (x < row.size()) next = pixel();
    }
  }

  Rgbe pixel() { return {byte(), byte(), byte(), byte()}; }
  std::uint8_t byte() {
    if (at_ == bytes_.size()) fail("the file ends early", "the file is truncated or damaged");
    return static_cast<std::uint8_t>(bytes_[at_++]);
  }
  std::string_view line() {
    const std::string_view left(bytes_.data() + at_, bytes_.size() - at_);
    const std::size_t end = left.find('\n');
    if (end == left.npos) fail("the header ends early", "the file is truncated or damaged");
    at_ += end + 1;
    return left.substr(0, end);
  }
  template <class T>
  T number(std::string_view text) const {
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    T value{};
    if (std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc()) fail(std::string(text), "no number");
    return value;
  }
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const {
    throw Error(source_.name(), fmt::format("byte {}", at_), problem, remedy);
  }

  const ByteSource& source_;
  std::vector<char> bytes_;
  std::size_t at_ = 0;
  int width_ = 0, height_ = 0;
  float exposure_ = 1;
};

/// One component of a row, in runs.
void append_runs(const std::vector<Rgbe>& row, std::size_t component, std::string& out) {
  const auto equal_from = [&](std::size_t x) {
    std::size_t end = x + 1;
    while (end < row.size() && end - x < kLongestRun && row[end][component] == row[x][component]) ++end;
    return end - x;
  };
  for (std::size_t x = 0; x < row.size();) {
    if (const std::size_t run = equal_from(x); run >= kShortestRun) {
      out += static_cast<char>(128 + run), out += static_cast<char>(row[x][component]);
      x += run;
      continue;
    }
    std::size_t end = x + 1;
    while (end < row.size() && end - x < kLongestDump && equal_from(end) < kShortestRun) ++end;
    out += static_cast<char>(end - x);
    for (; x < end; ++x) out += static_cast<char>(row[x][component]);
  }
}

}  // namespace

Image read_hdr(const ByteSource& source) { return HdrReader(source).read(); }

std::string encode_hdr(const std::string& name, const Image& image) {
  if (image.channel_count() != 3)
    throw Error(name, "", fmt::format("{} channels; Radiance HDR holds R, G and B", image.channel_count()), "write .exr");
  std::string out = fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", image.height, image.width);
  std::vector<Rgbe> row(static_cast<std::size_t>(image.width));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) row[static_cast<std::size_t>(x)] = pack(image.at(x, y));
    if (!in_runs(image.width)) {
      for (const Rgbe& p : row) out.append(p.begin(), p.end());
      continue;
    }
    out += {2, 2, static_cast<char>(image.width >> 8), static_cast<char>(image.width & 0xff)};
    for (std::size_t c = 0; c < 4; ++c) append_runs(row, c, out);
  }
  return out;
}

}  // namespace pelage::io
