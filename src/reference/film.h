// Where path samples gather: sums a pixel, in double precision, so that any split of the work adds up to the same bits.
#pragma once

#include <pelage/image.h>
#include <pelage/trace.h>

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "reference/path_tracer.h"

namespace pelage {

/// Sums over the samples of one pixel, and the nearest first hit among them. No padding: it goes to checkpoints as it stands.
struct FilmPixel {
  std::array<double, 3> sum{};      ///< radiance, W/(m²·sr)
  std::array<double, 3> squares{};  ///< of each channel
  std::array<double, 3> albedo{};
  double alpha = 0;
  double hair = 0;                                       ///< samples that see a strand first
  float depth = std::numeric_limits<float>::infinity();  ///< camera z of the nearest hit, metres
  Vec3 position, tangent, normal;
  Vec2 motion;  ///< pixels
  float u = 0;
  std::uint32_t groom = 0, strand = 0;  ///< from 1; 0: not a strand
  std::uint32_t samples = 0;
};
static_assert(sizeof(FilmPixel) == 11 * sizeof(double) + 16 * sizeof(float));

/// The state of a picture on its way. Pixels may stand at different sample counts (after a cancellation): each is a
/// prefix of its own samples.
struct Film {
  static constexpr std::size_t kBounces = PathSplit::kBounces, kLobes = PathSplit::kLobes;

  Film() = default;
  Film(int width, int height, bool with_bounces, bool with_lobes);

  int width = 0, height = 0;
  std::vector<FilmPixel> pixels;               ///< [h·w]
  std::vector<std::array<double, 3>> bounces;  ///< [h·w·kBounces] or empty
  std::vector<std::array<double, 3>> lobes;    ///< [h·w·kLobes] or empty
  double seconds = 0;                          ///< spent so far

  std::size_t bytes() const;
  /// Samples of the pixel that has fewest.
  std::uint32_t least_samples() const;
};

/// Adds the next sample of pixel `p`. Throws Error naming the pixel where the radiance is not finite.
void add_sample(Film& film, std::size_t p, const PathSample& sample);

/// Root of the mean variance of the pixels' mean luminances over their mean luminance, over pixels that anything is seen
/// in: the relative standard error of the picture. 0 where nothing is seen, infinite below two samples.
float picture_noise(const Film& film);

/// What is shown where a path saw nothing.
struct FilmBackdrop {
  Vec3 color;       ///< linear radiance
  float alpha = 1;  ///< 0: stays transparent
};

/// R, G, B, A and the channels of `layers`, by pixel means; `exposure` in stops, applied to whatever is light.
Image develop(const Film& film, std::span<const TraceLayer> layers, const FilmBackdrop& backdrop, float exposure);

}  // namespace pelage
