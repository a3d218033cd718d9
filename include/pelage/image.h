// Pictures in memory.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace pelage {

/// Interleaved float channels, row 0 on top, scene-linear unless its producer says otherwise.
struct Image {
  int width = 0, height = 0;          ///< pixels
  std::vector<std::string> channels;  ///< names in storage order: {"R","G","B","A"}, {"Z"}, …
  std::vector<float> pixels;          ///< [height·width·channels.size()]

  Image() = default;
  Image(int w, int h, std::vector<std::string> names);  ///< all 0
  std::size_t channel_count() const { return channels.size(); }
  float* at(int x, int y) { return pixels.data() + index(x, y); }
  const float* at(int x, int y) const { return pixels.data() + index(x, y); }

 private:
  std::size_t index(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) * channels.size();
  }
};

}  // namespace pelage
