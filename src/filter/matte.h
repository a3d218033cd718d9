// Hair without its background: what link and alpha fix hand on to the filter, and the filter to the picture.
#pragma once

#include <pelage/image.h>
#include <pelage/vec.h>

#include <cstddef>

#include "core/buffer.h"
#include "filter/pixel_mask.h"
#include "frame/visibility.h"

namespace pelage {

/// Hair in a pixel. One vector of eight floats, which the filter adds up as a whole.
struct MattePixel {
  float r = 0, g = 0, b = 0, alpha = 0;  ///< premultiplied linear color and opacity
  float weight = 0;                      ///< 1 where hair is or reaches, else 0
  float tangent_x = 0, tangent_y = 0;    ///< unit vector on the screen along the hair, sign arbitrary; 0, 0 for none
  float coverage = 0;                    ///< the opacity that the picture gets, where Matte::exact_coverage is set

  Vec2 tangent() const { return {tangent_x, tangent_y}; }
  void lie(Vec2 tangent) { weight = 1, tangent_x = tangent.x, tangent_y = tangent.y; }
};
static_assert(sizeof(MattePixel) == 8 * sizeof(float));

/// The hair of a part of a picture, with a border of empty pixels around it, so that a kernel needs no ends.
class Matte {
 public:
  Matte() = default;
  /// Pixels are undefined until clear() or a write.
  Matte(int width, int height, int border);

  int left = 0, top = 0;        ///< screen pixel of the picture that the first one inside the border is
  int width = 0, height = 0;    ///< screen pixels, without the border
  int border = 0;               ///< pixels
  bool exact_coverage = false;  ///< whether MattePixel::coverage is the opacity, and alpha an estimate of it
  PixelMask hair;               ///< pixels with a weight; the others of a filtered matte are undefined

  std::size_t stride() const { return static_cast<std::size_t>(width + 2 * border); }
  /// −border ≤ x < width + border, and so for y.
  MattePixel& at(int x, int y) { return pixels_[index(x, y)]; }
  const MattePixel& at(int x, int y) const { return pixels_[index(x, y)]; }
  std::size_t bytes() const { return pixels_.bytes(); }
  /// Empties all pixels, those of the border too.
  void clear();

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y + border) * stride() + static_cast<std::size_t>(x + border);
  }
  Buffer<MattePixel> pixels_;
};

/// Directions without a sign, such as tangents: their mean is that of the vectors of twice their angles.
class MeanDirection {
 public:
  void add(Vec2 t) { cos2_ += t.x * t.x - t.y * t.y, sin2_ += 2 * t.x * t.y; }
  /// A unit vector; 0 where nothing was added, or all cancels.
  Vec2 mean() const;

 private:
  float cos2_ = 0, sin2_ = 0;
};

/// Gives pixels without hair, but with some within `reach` pixels, the mean direction of that: the filter then closes gaps
/// as it thins what is around them, and hair keeps its energy. Pixels where the opaque scene is in front of all that hair are
/// no gaps: hair there is not missing, but hidden.
inline constexpr int kGapReach = 2;  ///< gaps between strands that one sample misses are a few pixels wide
void extend_tangents(Matte& matte, const StrandLayer& layer, int reach = kGapReach);

/// The matte over what is behind it: R, G, B, A, linear, premultiplied, times 2^exposure, for all of the picture. `layer` is
/// the one that the matte was made from.
Image lay_over(const Matte& matte, const StrandLayer& layer, const Behind& behind, float exposure);

}  // namespace pelage
