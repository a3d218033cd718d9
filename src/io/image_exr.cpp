// OpenEXR files through the OpenEXR library, from and to memory: the file system's errors stay ours to report.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfTileDescription.h>
#include <fmt/format.h>
#include <half.h>
#include <pelage/error.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "io/image_formats.h"

namespace pelage::io {
namespace {

class MemoryInput : public Imf::IStream {
 public:
  MemoryInput(const std::string& name, const std::vector<char>& bytes) : IStream(name.c_str()), bytes_(bytes) {}

  bool read(char target[], int count) override {
    const auto n = static_cast<std::uint64_t>(count);
    if (at_ > bytes_.size() || n > bytes_.size() - at_) throw std::runtime_error("the file ends early");
    std::memcpy(target, bytes_.data() + at_, n);
    at_ += n;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t position) override { at_ = position; }

 private:
  const std::vector<char>& bytes_;
  std::uint64_t at_ = 0;
};

class MemoryOutput : public Imf::OStream {
 public:
  explicit MemoryOutput(const std::string& name) : OStream(name.c_str()) {}

  void write(const char data[], int count) override {
    const auto n = static_cast<std::size_t>(count);
    bytes_.resize(std::max(bytes_.size(), at_ + n));
    std::memcpy(bytes_.data() + at_, data, n);
    at_ += n;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

struct KnownAttribute {
  std::string_view name, type;
  std::size_t size;  // bytes; 0: any
};
constexpr KnownAttribute kKnown[] = {{"channels", "chlist", 0},
                                     {"compression", "compression", 1},
                                     {"dataWindow", "box2i", 16},
                                     {"displayWindow", "box2i", 16},
                                     {"lineOrder", "lineOrder", 1},
                                     {"pixelAspectRatio", "float", 4},
                                     {"screenWindowCenter", "v2f", 8},
                                     {"screenWindowWidth", "float", 4},
                                     {"tiles", "tiledesc", 9},
                                     {"chunkCount", "int", 4},
                                     {"version", "int", 4},
                                     {"name", "string", 0},
                                     {"type", "string", 0}};

// The library asks for memory on the word of a header before it reads what is there. So every attribute has to be inside the
// file, those that say how pixels are stored have to be of their type and size, and all others are made unknown to it.
//   header: { name \0 type \0 size data }… \0; the list of headers of a file of several parts ends with an empty one
class HeaderGuard {
 public:
  HeaderGuard(const ByteSource& source, std::vector<char>& bytes) : source_(source), bytes_(bytes) {}

  /// Number of headers.
  int run() {
    constexpr std::uint32_t kSeveralParts = 0x1000;
    number();  // by which the format is known
    const bool several = number() & kSeveralParts;
    int headers = 0;
    while (attributes() > 0) {
      ++headers;
      if (!several) break;
    }
    return headers;
  }

 private:
  std::size_t attributes() {
    std::size_t count = 0;
    for (std::string_view name; !(name = text()).empty(); ++count) {
      const std::size_t type_at = at_;
      const std::string_view type = text();
      if (type.empty()) fail("an attribute without a type");
      const std::size_t size = number(), end = at_ + size;
      if (size > bytes_.size() - at_) fail("the header ends early");
      const auto* const known =
          std::find_if(std::begin(kKnown), std::end(kKnown), [&](const auto& k) { return k.name == name; });
      if (known == std::end(kKnown)) bytes_[type_at] = '?';
      else check(*known, type, size);
      at_ = end;
    }
    return count;
  }
  void check(const KnownAttribute& known, std::string_view type, std::size_t size) {
    constexpr std::size_t kChannel = 16;  // bytes behind its name
    const std::size_t end = at_ + size;
    if (known.type != type || (known.size != 0 && known.size != size)) fail("an attribute of the wrong type or size");
    if (known.name == "chunkCount" && number() > bytes_.size() / 8) fail("more parts than the file can hold");
    if (known.name == "tiles" && (number() > kLargestTile || number() > kLargestTile)) fail("tiles too large");
    if (known.name != "channels") return;
    while (!text().empty()) at_ = std::min(at_ + kChannel, bytes_.size());
    if (at_ != end) fail("channels that end elsewhere than they say");
  }
  std::string_view text() {
    const std::string_view left(bytes_.data() + at_, bytes_.size() - at_);
    const std::size_t end = left.find('\0');
    if (end == left.npos) fail("the header ends early");
    at_ += end + 1;
    return left.substr(0, end);
  }
  std::uint32_t number() {
    if (bytes_.size() - at_ < 4) fail("the header ends early");
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes_[at_ + i]);
    at_ += 4;
    return value;
  }
  [[noreturn]] void fail(const char* problem) const {
    throw Error(source_.name(), fmt::format("byte {}", at_), problem, "the file is truncated or damaged");
  }

  static constexpr std::uint32_t kLargestTile = 1 << 16;  // pixels a side

  const ByteSource& source_;
  std::vector<char>& bytes_;
  std::size_t at_ = 0;
};

void check_header(const ByteSource& source, const Imf::Header& header) {
  constexpr std::int64_t kMostRows = 256;  // that are unpacked together
  const Imath::Box2i& window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  std::uint64_t channels = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    ++channels;
    if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
      throw Error(source.name(), c.name(), "a channel of lower resolution", "convert it to channels of one size");
  }
  check_image_size(source, width, height, channels);
  check_image_size(source, width, std::max(height, kMostRows), channels);
  if (!header.hasTileDescription()) return;
  const Imf::TileDescription& tiles = header.tileDescription();
  if (tiles.xSize == 0 || tiles.ySize == 0) throw Error(source.name(), "tiles", "no pixels", "the file is damaged");
  const std::int64_t count = (width / tiles.xSize + 1) * (height / tiles.ySize + 1);
  if (static_cast<std::uint64_t>(count) > source.size())
    throw Error(source.name(), "tiles", fmt::format("{} cannot be in {} bytes", count, source.size()), "the file is damaged");
  check_image_size(source, tiles.xSize, tiles.ySize, channels);
}

// Headers are read by themselves before the file is opened, which asks for memory on the word of their numbers.
void check_headers(const ByteSource& source, MemoryInput& input, int count) {
  std::array<unsigned char, 8> start;  // magic number, version
  input.read(reinterpret_cast<char*>(start.data()), static_cast<int>(start.size()));
  int version = start[4] | start[5] << 8 | start[6] << 16;
  for (int i = 0; i < count; ++i) {
    Imf::Header header;
    header.readFrom(input, version);
    check_header(source, header);
  }
  input.seekg(0);
}

// Channels stand in the file by name, "A" before "B": colors are put into their usual order.
std::vector<std::string> ordered_channels(const Imf::ChannelList& channels) {
  const auto layer = [](std::string_view name) { return name.substr(0, name.find_last_of('.') + 1); };
  const auto rank = [&](std::string_view name) {
    constexpr std::string_view kFirst[] = {"R", "G", "B", "A", "Z"};
    const std::string_view own = name.substr(layer(name).size());
    return std::find(std::begin(kFirst), std::end(kFirst), own) - std::begin(kFirst);
  };
  std::vector<std::string> names;
  for (auto c = channels.begin(); c != channels.end(); ++c) names.emplace_back(c.name());
  std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
    return layer(a) != layer(b) ? layer(a) < layer(b) : rank(a) < rank(b);
  });
  return names;
}

/// Slices of interleaved pixels of type T, which fill `window`.
template <class T>
Imf::FrameBuffer interleaved(const std::vector<std::string>& channels, Imf::PixelType type, const T* pixels,
                             const Imath::Box2i& window) {
  const std::size_t pixel = channels.size() * sizeof(T);
  const std::size_t row = pixel * static_cast<std::size_t>(window.max.x - window.min.x + 1);
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < channels.size(); ++c)
    buffer.insert(channels[c], Imf::Slice::Make(type, pixels + c, window, pixel, row));
  return buffer;
}

template <class T>
void write_pixels(Imf::OutputFile& file, const Image& image, Imf::PixelType type, const T* pixels) {
  file.setFrameBuffer(interleaved(image.channels, type, pixels, file.header().dataWindow()));
  file.writePixels(image.height);
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace

Image read_exr(const ByteSource& source) {
  std::vector<char> bytes = source.read_all();
  const int headers = HeaderGuard(source, bytes).run();
  try {
    MemoryInput input(source.name(), bytes);
    check_headers(source, input, headers);
    Imf::InputFile file(input);
    const Imath::Box2i& window = file.header().dataWindow();
    Image image(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, ordered_channels(file.header().channels()));
    file.setFrameBuffer(interleaved(image.channels, Imf::FLOAT, image.pixels.data(), window));
    file.readPixels(window.min.y, window.max.y);
    return image;
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(source.name(), "", first_line(e.what()), "the file is truncated or damaged");
  }
}

std::string encode_exr(const std::string& name, const Image& image, bool full_float) {
  try {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    const Imf::PixelType type = full_float ? Imf::FLOAT : Imf::HALF;
    for (const std::string& channel : image.channels) header.channels().insert(channel, Imf::Channel(type));
    MemoryOutput output(name);
    {
      Imf::OutputFile file(output, header);  // complete when it goes
      if (full_float) {
        write_pixels(file, image, type, image.pixels.data());
      } else {
        std::vector<half> halves(image.pixels.begin(), image.pixels.end());
        write_pixels(file, image, type, halves.data());
      }
    }
    return output.take();
  } catch (const std::exception& e) {
    throw Error(name, "", first_line(e.what()), "");
  }
}

}  // namespace pelage::io
