// Pictures in and out: which format, which transfer curve; the formats themselves are in image_formats.h.
#include <pelage/error.h>
#include <pelage/io.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "io/atomic_file.h"
#include "io/byte_source.h"
#include "core/srgb.h"
#include "io/file_kind.h"
#include "io/image_formats.h"

namespace pelage {
namespace {

bool is_alpha(const std::string& channel) { return channel == "A" || channel == "a" || channel.ends_with(".A"); }

void linearize_colors(Image& image) {
  const std::size_t n = image.channel_count();
  for (std::size_t c = 0; c < n; ++c) {
    if (is_alpha(image.channels[c])) continue;
    for (std::size_t i = c; i < image.pixels.size(); i += n) image.pixels[i] = srgb_to_linear(image.pixels[i]);
  }
}

std::string lower_extension(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  std::string extension = dot == std::string::npos || path[dot] == '/' ? "" : path.substr(dot + 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

Image read_pixels(const io::ByteSource& source, const std::string& format) {
  if (format == "exr") return io::read_exr(source);
  if (format == "hdr") return io::read_hdr(source);
  return format == "png" ? io::read_png(source) : io::read_jpeg(source);
}

std::string encode(const std::string& path, const std::string& extension, const Image& image, bool full_float) {
  if (extension == "exr") return io::encode_exr(path, image, full_float);
  return extension == "hdr" ? io::encode_hdr(path, image) : io::encode_png(path, image, full_float);
}

}  // namespace

void io::check_image_size(const ByteSource& source, std::int64_t width, std::int64_t height, std::uint64_t channels) {
  constexpr std::int64_t kMaxSide = 1 << 16;
  const std::string size = fmt::format("{} × {} pixels of {} channels", width, height, channels);
  if (width <= 0 || height <= 0 || channels == 0 || width > kMaxSide || height > kMaxSide)
    throw Error(source.name(), "", size, "1 × 1 to 65536 × 65536 are read");
  // A file that states a larger picture must itself be a fair part of it: memory is not asked for on the word of a few bytes.
  constexpr std::uint64_t kAlwaysRead = 1 << 28, kMostPacked = 2048;
  const std::uint64_t bytes =
      static_cast<std::uint64_t>(width * height) * sizeof(float) * std::min<std::uint64_t>(channels, 1 << 16);
  if (bytes > kAlwaysRead && bytes / kMostPacked > source.size())
    throw Error(source.name(), "", fmt::format("{} cannot be in {} bytes", size, source.size()),
                "the file is truncated or damaged");
}

Image read_image(const std::string& path, bool linearize) {
  const io::ByteSource source = io::ByteSource::open(path);  // which says best why a file cannot be read
  const std::string format = io::image_format(source);
  if (format.empty()) throw Error(path, "", "not a picture", "EXR, PNG, JPEG and Radiance HDR are read");
  Image image = read_pixels(source, format);
  if (linearize && (format == "png" || format == "jpeg")) linearize_colors(image);
  return image;
}

void write_image(const std::string& path, const Image& image, bool full_float) {
  const std::string extension = lower_extension(path);
  if (extension != "exr" && extension != "png" && extension != "hdr")
    throw Error(path, "", fmt::format("the extension '{}' names no image format", extension), "write .exr, .png or .hdr");
  if (image.width <= 0 || image.height <= 0 || image.channels.empty() ||
      image.pixels.size() !=
          static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * image.channel_count())
    throw Error(path, "", "an empty image, or one whose pixels do not match its size", "");
  io::AtomicFile file(path);
  file.write(encode(path, extension, image, full_float));  // in one piece: nothing half encoded can remain
  file.commit();
}

}  // namespace pelage
