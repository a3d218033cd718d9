// PNG files through libpng, from and to memory; it tells us of damage, and nobody else.
#include "io/image_formats.h"

#include <fmt/format.h>
#include <pelage/error.h>
#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace pelage::io {
namespace {

constexpr png_uint_32 kMaxSide = 1 << 16;
constexpr std::uint64_t kMostPacked = 1032;  // bytes that one byte of a deflate stream can stand for

// What libpng's callbacks see. Trivial, because they leave by longjmp.
struct Stream {
  const char* bytes;
  std::size_t size, at;
  char problem[128];
};

void fetch(png_structp png, png_bytep target, std::size_t bytes) {
  Stream& s = *static_cast<Stream*>(png_get_io_ptr(png));
  if (bytes > s.size - s.at) png_error(png, "the file ends early");
  std::memcpy(target, s.bytes + s.at, bytes);
  s.at += bytes;
}

[[noreturn]] void note_error(png_structp png, png_const_charp what) {
  Stream& s = *static_cast<Stream*>(png_get_error_ptr(png));
  std::strncpy(s.problem, what, sizeof s.problem - 1);
  png_longjmp(png, 1);
}

// Damage that leaves every pixel as it was written is no news to anybody.
void ignore_warning(png_structp, png_const_charp) {}

// Runs libpng's functions. Their errors come back here over frames that own nothing: then false.
template <class Calls>
bool guarded(png_structp png, const Calls& calls) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  calls();
  return true;
}

class PngReader {
 public:
  explicit PngReader(const ByteSource& source) : name_(source.name()), bytes_(source.read_all()) {
    stream_ = {bytes_.data(), bytes_.size(), 0, {}};
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &stream_, note_error, ignore_warning);
    if (png_) info_ = png_create_info_struct(png_);
    if (!info_) fail("libpng cannot start");
    png_set_read_fn(png_, &stream_, fetch);
  }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }

  Image read() {
    check_chunks();
    read_header();
    const std::size_t row = png_get_rowbytes(png_, info_), height = png_get_image_height(png_, info_);
    std::vector<png_byte> bytes(row * height);
    std::vector<png_bytep> rows(height);
    for (std::size_t y = 0; y < height; ++y) rows[y] = bytes.data() + y * row;
    run([&] {
      png_read_image(png_, rows.data());
      png_read_end(png_, nullptr);
    });
    return to_floats(bytes);
  }

 private:
  template <class Calls>
  void run(const Calls& calls) {
    if (!guarded(png_, calls)) fail(stream_.problem);
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw Error(name_, fmt::format("byte {}", stream_.at), problem, "the PNG file is truncated or damaged");
  }

  // Every chunk must be inside the file: libpng asks for its memory before it reads it.
  void check_chunks() {
    constexpr std::size_t kSignature = 8, kFrame = 12;  // around a chunk's data: its length, name and checksum
    for (std::size_t at = kSignature; at < bytes_.size();) {
      stream_.at = at;
      const std::size_t left = bytes_.size() - at;
      if (left < kFrame) fail("the file ends early");
      const std::size_t data = png_get_uint_32(reinterpret_cast<png_const_bytep>(bytes_.data() + at));
      if (data > left - kFrame) fail("the file ends early");
      if (std::memcmp(bytes_.data() + at + 4, "IEND", 4) == 0) break;
      at += kFrame + data;
    }
    stream_.at = 0;
  }

  void read_header() {
    run([this] {
      png_set_user_limits(png_, kMaxSide, kMaxSide);
      png_read_info(png_, info_);
      png_set_expand(png_);
      if constexpr (std::endian::native == std::endian::little) png_set_swap(png_);
      png_set_interlace_handling(png_);
    });
    // Before expansion, as the rows stand in the file, behind a byte that says how the row was filtered.
    const std::uint64_t rows = png_get_image_height(png_, info_), row = png_get_rowbytes(png_, info_);
    if (rows * row / kMostPacked > bytes_.size())
      fail(fmt::format("{} × {} pixels cannot be in {} bytes", png_get_image_width(png_, info_), rows, bytes_.size()));
    run([this] { png_read_update_info(png_, info_); });
  }

  Image to_floats(const std::vector<png_byte>& bytes) const {
    const std::vector<std::string> names[] = {{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
    Image image(static_cast<int>(png_get_image_width(png_, info_)), static_cast<int>(png_get_image_height(png_, info_)),
                names[png_get_channels(png_, info_) - 1]);
    if (png_get_bit_depth(png_, info_) == 8) {
      for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(bytes[i]) / 255;
      return image;
    }
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      std::uint16_t value;
      std::memcpy(&value, bytes.data() + 2 * i, sizeof value);
      image.pixels[i] = static_cast<float>(value) / 65535;
    }
    return image;
  }

  std::string name_;
  std::vector<char> bytes_;
  Stream stream_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

// What the writer's callbacks see.
struct Target {
  Stream stream;  // first: note_error() looks for it there
  std::string bytes;
};

void append(png_structp png, png_bytep data, std::size_t bytes) {
  static_cast<Target*>(png_get_io_ptr(png))->bytes.append(reinterpret_cast<const char*>(data), bytes);
}

class PngWriter {
 public:
  explicit PngWriter(const std::string& name) : name_(name) {
    png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, &target_.stream, note_error, ignore_warning);
    if (png_) info_ = png_create_info_struct(png_);
    if (!info_) throw Error(name_, "", "libpng cannot start", "");
    png_set_write_fn(png_, &target_, append, nullptr);
  }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png_, &info_); }

  std::string write(const Image& image, bool sixteen_bits) {
    constexpr int kColors[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};
    const auto width = static_cast<png_uint_32>(image.width), height = static_cast<png_uint_32>(image.height);
    const std::size_t values = width * image.channel_count();
    std::vector<png_byte> row(values * (sixteen_bits ? 2 : 1));
    const bool written = guarded(png_, [&] {
      png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
      png_set_IHDR(png_, info_, width, height, sixteen_bits ? 16 : 8, kColors[image.channel_count() - 1], PNG_INTERLACE_NONE,
                   PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
      png_set_sRGB(png_, info_, PNG_sRGB_INTENT_PERCEPTUAL);
      png_write_info(png_, info_);
      for (int y = 0; y < image.height; ++y) {
        to_row(image.at(0, y), values, sixteen_bits, row.data());
        png_write_row(png_, row.data());
      }
      png_write_end(png_, info_);
    });
    if (!written) throw Error(name_, "", target_.stream.problem, "");
    return std::move(target_.bytes);
  }

 private:
  static void to_row(const float* from, std::size_t values, bool sixteen_bits, png_byte* to) {
    const auto level = [](float x, float most) {
      const float share = x > 0 ? std::min(x, 1.f) : 0.f;  // of NaN: 0
      const float next_half = share * most + 0.5f;
      return static_cast<unsigned>(next_half);
    };
    for (std::size_t i = 0; i < values; ++i) {
      if (!sixteen_bits) {
        to[i] = static_cast<png_byte>(level(from[i], 255));
        continue;
      }
      const unsigned value = level(from[i], 65535);  // big-endian in the file
      to[2 * i] = static_cast<png_byte>(value >> 8), to[2 * i + 1] = static_cast<png_byte>(value & 0xff);
    }
  }

  const std::string& name_;
  Target target_{};
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

}  // namespace

Image read_png(const ByteSource& source) { return PngReader(source).read(); }

std::string encode_png(const std::string& name, const Image& image, bool sixteen_bits) {
  if (image.channel_count() > 4)
    throw Error(name, "", fmt::format("{} channels; PNG holds at most 4", image.channel_count()), "write .exr");
  return PngWriter(name).write(image, sixteen_bits);
}

}  // namespace pelage::io
