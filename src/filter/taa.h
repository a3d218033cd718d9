// Temporal anti-aliasing: every frame takes one sample of each pixel somewhere else, and is blended into what the frames
// before it have shown of the same place of the world.
//
// After Karis 2014 (references.bib: Karis2014Temporal) and the survey of Yang, Liu and Salvi 2020 (references.bib: Yang2020Survey):
// Halton jitter, motion of the nearest thing in 3×3 pixels, history read with Catmull-Rom weights, rejected where it shows
// something else, and clipped to the colors around the pixel (variance clipping, references.bib: Salvi2016Excursion).
// Karis' weights by brightness are left out: they would pull the mean away from the box-filtered reference.
#pragma once

#include <pelage/image.h>

#include "core/buffer.h"
#include "frame/frame.h"

namespace pelage {

struct TaaSettings {
  float least_blend = 1.f / 16;  ///< share of a new frame once a pixel has a long history; before: its mean with all others
  float clip_deviations = 1.5f;  ///< half size of the box of allowed colors, standard deviations of 3×3 pixels; +inf: no box
  float same_place = 1;          ///< pixels by which the history's thing may have moved otherwise than the pixel's
};

/// One frame with a sample at `position` of every pixel (0…1).
struct TaaFrame {
  Image color;          ///< R, G, B, A, linear, premultiplied
  Buffer<float> depth;  ///< [h·w] camera z of what the sample sees, metres, +inf for nothing
  CameraView view;      ///< without jitter
  Vec2 position;
  Buffer<Vec3> way = {};  ///< [h·w] metres, world: from where it is to where it was in the frame before; empty: nothing moved
};

/// The picture so far, and what it takes to go on.
class TaaHistory {
 public:
  explicit TaaHistory(const TaaSettings& settings = {}) : settings_(settings) {}

  /// Blends a frame in: of the same size as the first, from any camera. O(pixels), rows in parallel; the result has the
  /// same bits for any number of threads.
  void add(TaaFrame frame);
  /// R, G, B, A, linear, premultiplied.
  const Image& picture() const { return color_; }
  std::size_t bytes() const { return color_.pixels.size() * sizeof(float) + depth_.bytes() + age_.bytes(); }

 private:
  TaaSettings settings_;
  Image color_;
  Buffer<float> depth_;  // of the last frame, at its samples
  Buffer<float> age_;    // frames that a pixel's color is the mean of
  CameraView view_;
  Vec2 position_;
};

}  // namespace pelage
