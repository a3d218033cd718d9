#include <pelage/image.h>

#include <utility>

#include "core/buffer.h"

namespace pelage {

Image::Image(int w, int h, std::vector<std::string> names) : width(w), height(h), channels(std::move(names)) {
  const std::size_t size = static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * channels.size();
  pixels.reserve(size);
  prefer_huge_pages(pixels.data(), size * sizeof(float));
  pixels.resize(size);
}

}  // namespace pelage
