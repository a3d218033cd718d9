// Hair without its background: what link and alpha fix hand on to the filter, and the filter to the picture.
#pragma once

#include <pelage/image.h>
#include <pelage/vec.h>

#include <cstddef>

#include "core/buffer.h"
#include "core/pixel_mask.h"
#include "frame/visibility.h"

namespace pelage {

/// The hair of a part of a picture, with a border of empty pixels around it, so that a kernel needs no ends. Buffers are
/// [height + 2·border][stride()]: see index().
class Matte {
 public:
  Matte() = default;
  /// Pixels are undefined until they are cleared or written.
  Matte(int width, int height, int border, bool exact_coverage);
  /// Takes the hair out of rows first ≤ y < last: color and weight. Those at the edge of the matte with the border beside them.
  void clear(int first, int last);

  int left = 0, top = 0;      ///< screen pixel of the picture that the first one inside the border is
  int width = 0, height = 0;  ///< screen pixels, without the border
  int border = 0;             ///< pixels

  PixelMask hair;           ///< pixels that show hair, or lie in a gap of it
  Buffer<Vec4> color;       ///< premultiplied linear R, G, B and opacity; 0 without hair
  Buffer<float> weight;     ///< 1 for the pixels of `hair`, else 0
  Buffer<Vec2> tangent;     ///< unit vector on the screen along the hair, sign arbitrary; 0, 0 seen end-on. Only for `hair`
  Buffer<float> thickness;  ///< diameter of a strand, pixels; 0 where nobody knows. Only for `hair`
  Buffer<float> coverage;   ///< the opacity that the picture gets, where it is known exactly; else empty

  std::size_t stride() const { return static_cast<std::size_t>(width) + 2 * static_cast<std::size_t>(border); }
  /// −border ≤ x < width + border, and so for y.
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y + border) * stride() + static_cast<std::size_t>(x + border);
  }
  /// Makes a pixel one of hair, `thick` pixels thick, that lies along `t`; hair.add() is for the caller.
  void lie(int x, int y, Vec2 t, float thick = 0) {
    const std::size_t p = index(x, y);
    weight[p] = 1, tangent[p] = t, thickness[p] = thick;
  }
  std::size_t bytes() const { return color.bytes() + weight.bytes() + tangent.bytes() + thickness.bytes() + coverage.bytes(); }
};

/// Directions without a sign, such as tangents: their mean is that of the vectors of twice their angles.
class MeanDirection {
 public:
  /// The vector of twice the angle of a unit vector.
  static Vec2 doubled(Vec2 t) { return {t.x * t.x - t.y * t.y, 2 * t.x * t.y}; }
  /// A unit vector of half the angle; 0 for 0.
  static Vec2 halved(Vec2 d);
  void add(Vec2 t) { sum_ = sum_ + doubled(t); }
  /// A unit vector; 0 where nothing was added, or all cancels.
  Vec2 mean() const { return halved(sum_); }

 private:
  Vec2 sum_;
};

/// Gives pixels without hair, but with some within `reach` pixels, the mean direction and thickness of that: the filter then closes gaps
/// as it thins what is around them, and hair keeps its energy. Pixels where the opaque scene is in front of all that hair are
/// no gaps: hair there is not missing, but hidden.
inline constexpr int kGapReach = 2;  ///< gaps between strands that one sample misses are a few pixels wide
void extend_tangents(Matte& matte, const StrandLayer& layer, int reach = kGapReach);

/// The matte over what is behind it: R, G, B, A, linear, premultiplied, times 2^exposure, for all of the picture. `layer` is
/// the one that the matte was made from; `filtered` takes the place of its color where given (filter_anisotropic()).
Image lay_over(const Matte& matte, const Buffer<Vec4>& filtered, const StrandLayer& layer, const Behind& behind,
               float exposure);

}  // namespace pelage
