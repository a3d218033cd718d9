// Pictures in and out through OpenImageIO; PNG files come in through libpng (image_png.h).
#include <pelage/error.h>
#include <pelage/io.h>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "io/atomic_file.h"
#include "io/byte_source.h"
#include "core/srgb.h"
#include "io/file_kind.h"
#include "io/image_png.h"

namespace pelage {
namespace {

constexpr int kMaxSide = 1 << 16;
// A file that states a larger picture must itself be a fair part of that: memory is not asked for on the word of a few bytes.
constexpr std::uint64_t kAlwaysRead = 1 << 30, kMostPacked = 2048;

bool is_alpha(const std::string& channel) { return channel == "A" || channel == "a" || channel.ends_with(".A"); }

void linearize_colors(Image& image) {
  const std::size_t n = image.channel_count();
  for (std::size_t c = 0; c < n; ++c) {
    if (is_alpha(image.channels[c])) continue;
    for (std::size_t i = c; i < image.pixels.size(); i += n) image.pixels[i] = srgb_to_linear(image.pixels[i]);
  }
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::string lower_extension(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  std::string extension = dot == std::string::npos || path[dot] == '/' ? "" : path.substr(dot + 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

OIIO::ImageSpec make_spec(const std::string& path, const Image& image, const std::string& extension, bool full) {
  const OIIO::TypeDesc type = extension == "exr"   ? (full ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::HALF)
                              : extension == "png" ? (full ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8)
                                                   : OIIO::TypeDesc::FLOAT;
  OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(image.channel_count()), type);
  if (extension == "hdr" && image.channel_count() != 3)
    throw Error(path, "", fmt::format("{} channels; Radiance HDR holds R, G and B", image.channel_count()), "write .exr");
  if (extension == "png" && image.channel_count() > 4)
    throw Error(path, "", fmt::format("{} channels; PNG holds at most 4", image.channel_count()), "write .exr");
  spec.channelnames = image.channels;
  spec.alpha_channel = -1;
  for (std::size_t c = 0; c < image.channel_count(); ++c)
    if (is_alpha(image.channels[c])) spec.alpha_channel = static_cast<int>(c);
  // Values go into the file as they stand: no multiplication or division by alpha, no transfer curve.
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("compression", "zip");
  if (extension == "png") spec.attribute("oiio:ColorSpace", "sRGB");
  return spec;
}

Image read_by_oiio(const io::ByteSource& source) {
  const std::string& path = source.name();
  OIIO::ImageSpec wishes;
  wishes.attribute("oiio:UnassociatedAlpha", 1);
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path, &wishes);
  if (!input) throw Error(path, "", first_line(OIIO::geterror()), "EXR, PNG and Radiance HDR are read");
  const OIIO::ImageSpec& spec = input->spec();
  const std::string size =
      fmt::format("{} × {} × {} pixels of {} channels", spec.width, spec.height, spec.depth, spec.nchannels);
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0 || spec.width > kMaxSide || spec.height > kMaxSide ||
      spec.depth > 1)
    throw Error(path, "", size, "at most 65536 × 65536 are read");
  if (spec.image_bytes() > kAlwaysRead && spec.image_bytes() / kMostPacked > source.size())
    throw Error(path, "", fmt::format("{} cannot be in {} bytes", size, source.size()), "the file is truncated or damaged");
  Image image(spec.width, spec.height, spec.channelnames);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data()))
    throw Error(path, "pixels", first_line(input->geterror()), "the file is truncated or damaged");
  return image;
}

}  // namespace

Image read_image(const std::string& path, bool linearize) {
  const io::ByteSource source = io::ByteSource::open(path);  // which says best why a file cannot be read
  const std::string format = io::image_format(source);
  if (format.empty()) throw Error(path, "", "not a picture", "EXR, PNG and Radiance HDR are read");
  if (format == "exr" || format == "hdr") return read_by_oiio(source);
  Image image = format == "png" ? io::read_png(source) : read_by_oiio(source);
  if (linearize) linearize_colors(image);
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

  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(extension);
  if (!output) throw Error(path, "", first_line(OIIO::geterror()), "");
  // Encoded in memory, so that the file system's errors are ours to report and nothing half written can remain.
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  OIIO::ImageSpec spec = make_spec(path, image, extension, full_float);
  if (!output->supports("ioproxy")) throw Error(path, "", "OpenImageIO cannot write this format to memory", "");
  output->set_ioproxy(&memory);
  if (!output->open(path, spec) || !output->write_image(OIIO::TypeDesc::FLOAT, image.pixels.data()) || !output->close())
    throw Error(path, "", first_line(output->geterror()), "");
  file.write(bytes.data(), bytes.size());
  file.commit();
}

}  // namespace pelage
