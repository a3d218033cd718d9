// Hair without its background: what link and alpha fix hand on to the filter, and the filter to the picture.
#pragma once

#include <pelage/image.h>
#include <pelage/vec.h>

#include "core/buffer.h"
#include "frame/visibility.h"

namespace pelage {

/// Premultiplied linear color and opacity of the hair alone, one plane a channel, [h·w] each.
struct Matte {
  int width = 0, height = 0;
  Buffer<float> r, g, b, alpha;
  Buffer<float> tangent_x, tangent_y;  ///< unit vector on the screen along the hair, sign arbitrary; 0, 0 far from hair
  Buffer<float> coverage;              ///< the opacity that the picture gets, where it is known exactly; else empty

  void resize(int w, int h, bool exact_coverage);
};

/// Directions without a sign, such as tangents: their mean is that of the vectors of twice their angles.
class MeanDirection {
 public:
  void add(Vec2 t, float weight = 1) { cos2_ += weight * (t.x * t.x - t.y * t.y), sin2_ += weight * 2 * t.x * t.y; }
  /// Sums as they are, of this and of another.
  Vec2 doubled() const { return {cos2_, sin2_}; }
  void add_doubled(Vec2 sum) { cos2_ += sum.x, sin2_ += sum.y; }
  /// A unit vector; 0 where nothing was added, or all cancels.
  Vec2 mean() const;

 private:
  float cos2_ = 0, sin2_ = 0;
};

/// Gives pixels without hair, but with some within `reach` pixels, the mean direction of that: the filter then closes gaps
/// as it thins what is around them, and hair keeps its energy.
inline constexpr int kGapReach = 2;  ///< gaps between strands that one sample misses are a few pixels wide
void extend_tangents(Matte& matte, int reach = kGapReach);

/// The matte over what is behind it, StrandLayer::behind: R, G, B, A, linear, premultiplied, times 2^exposure.
Image lay_over(const Matte& matte, const StrandLayer& layer, float exposure);

}  // namespace pelage
