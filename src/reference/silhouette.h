// Where in the picture a camera's rays can meet anything at all.
#pragma once

#include <pelage/vec.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "frame/frame.h"

namespace pelage {

/// Squares of pixels, each marked where something may be seen through it. Rays through others need not be traced.
class Silhouette {
 public:
  explicit Silhouette(const CameraView& view);

  /// Something that lies within the convex hull of balls (world position, radius in metres). Marks at least a pixel more
  /// than it covers, everything where a ball reaches behind the eye. One thread at a time.
  void add(std::span<const Vec4> balls);

  /// Whether anything was added that pixel (x, y) may see; 0 ≤ x < view.width, likewise y.
  bool covers(int x, int y) const { return marked_[index(x / kSquare, y / kSquare)] != 0; }

 private:
  static constexpr int kSquare = 4;  ///< pixels a side
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }

  CameraView view_;
  int columns_, rows_;
  std::vector<std::uint8_t> marked_;  ///< [rows · columns]
};

}  // namespace pelage
