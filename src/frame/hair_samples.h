// What the pixels of a G-buffer from a file show of strands; from Image to arrays, with every value checked.
#pragma once

#include <pelage/denoise.h>
#include <pelage/image.h>

#include <cstddef>
#include <cstdint>

#include "core/buffer.h"

namespace pelage {

/// [h·w] each; of pixels without hair only color, alpha, depth and background mean anything.
struct HairSamples {
  int width = 0, height = 0;
  Buffer<Vec3> color;       ///< linear radiance of what the sample sees
  Buffer<float> alpha;      ///< of pixels without hair
  Buffer<float> depth;      ///< of what the sample sees, any unit, growing with distance; +inf for nothing
  Buffer<float> strand;     ///< a number of its own for each strand; 0 for no hair
  Buffer<float> groom;      ///< or empty; strands of different grooms may share a number
  Buffer<float> u;          ///< 0 at the root … 1 at the tip
  bool on_screen = true;    ///< the next two are in pixels, z = 0
  Buffer<Vec3> position;    ///< metres, say, in any space
  Buffer<Vec3> tangent;     ///< any length, in the space of `position`
  Buffer<Vec4> background;  ///< premultiplied; or empty
  Buffer<float> coverage;   ///< share of the pixel that hair covers; or empty
  Buffer<float> thickness;  ///< diameter of the strand, pixels; or empty

  bool is_hair(std::size_t p) const { return strand[p] != 0; }
  /// Two 32-bit numbers that tell strands apart.
  std::uint64_t strand_key(std::size_t p) const;
};

/// Reads the fields of gbuffer_fields() by their names in the picture. Throws Error("G-buffer", …); see denoise().
HairSamples read_hair_samples(const Image& gbuffer, const std::map<std::string, std::string>& names);

}  // namespace pelage
