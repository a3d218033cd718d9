// Strands from nothing but the samples of a picture: what linking walks along where there is no groom.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/buffer.h"
#include "filter/camera_fit.h"
#include "filter/strand_curves.h"
#include "frame/hair_samples.h"

namespace pelage {

struct SampleCurveSettings {
  float reach = 16;  ///< pixels that a curve goes on straight beyond its last samples
  float piece = 10;  ///< pixels of a primitive, about; > 0
};

/// A curve for every strand that `samples` show: its samples, ordered by u, joined by cubic Hermite curves with their tangents, and
/// straight on at the ends, not beyond u = 0 and 1 (docs/derivations/linking.md). Tangents that point against u are turned.
///
/// The parameter s of a curve is u times the number of primitives that its length makes. Curves run where `position` is, and are
/// seen by the camera that fits positions to pixels best; samples that are given on the screen are their own positions. Holds what it needs.
class SampleCurves final : public StrandCurves {
 public:
  /// Throws Error where positions fit no camera, or 30 bits cannot name the primitives.
  SampleCurves(const HairSamples& samples, const SampleCurveSettings& settings);

  StrandCurve curve_of(std::uint32_t primitive) const override;
  bool at(StrandCurve& curve, float s, CurvePoint& point) const override;
  float step(StrandCurve& curve, float s, float depth, float pixels) const override;

  /// [h·w] the samples as visibility pixels; handed out once.
  Buffer<VisibilitySample> take_visibility() { return std::move(visibility_); }
  std::size_t strand_count() const { return strands_.size(); }
  /// Pixels, root of the mean square, between samples and where the camera sees them; none for samples on the screen.
  std::optional<float> camera_error() const { return camera_error_; }

 private:
  /// One sample, or the mean of several that lie side by side.
  struct Knot {
    float u, depth;
    Vec3 position, tangent;  ///< unit length; 0 where nobody knows
  };
  struct Strand {
    std::uint32_t first_knot, knot_end, first_primitive, primitives;
    float speed;  ///< length per u
  };
  struct Place {
    Vec3 position, tangent;
    float depth;
    float speed;  ///< length per u, about
  };
  struct Maker;

  bool place(const Strand& strand, float u, Place& place) const;

  ProjectiveCamera camera_;
  SampleCurveSettings settings_;
  std::vector<Knot> knots_;
  std::vector<Strand> strands_;
  std::vector<std::uint32_t> first_primitive_;  ///< of each strand: what curve_of() searches
  Buffer<VisibilitySample> visibility_;
  std::optional<float> camera_error_;
};

}  // namespace pelage
