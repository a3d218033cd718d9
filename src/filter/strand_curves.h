// The curves that strand linking walks along, on the screen.
#pragma once

#include <pelage/scene.h>

#include <cstdint>

#include "frame/frame.h"
#include "frame/segment_lookup.h"
#include "frame/visibility.h"

namespace pelage {

/// A strand, and how far its parameter s runs: from 0 at the root to `end` at the tip.
struct StrandCurve {
  std::uint32_t first_primitive = 0;  ///< of the strand: primitive p begins at s = p − first_primitive
  std::uint32_t groom = 0, strand = 0;
  float end = 0;

  /// What StrandCurves has looked up of it last: the span at hand, in a form of its own.
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::uint32_t span = kNone;
  Vec3 control[4] = {};
};

/// A place on a strand.
struct CurvePoint {
  Vec2 screen;      ///< pixels
  float depth = 0;  ///< camera z, metres
  Vec2 tangent;     ///< unit vector on the screen, root to tip; 0 where it is seen end-on
};

/// Where linking gets strands from: the groom that was rendered, or the samples of it that a picture holds.
class StrandCurves {
 public:
  virtual ~StrandCurves() = default;
  /// The strand of a primitive.
  virtual StrandCurve curve_of(std::uint32_t primitive) const = 0;
  /// Says that curve_of() and at() will soon be asked for this primitive.
  virtual void prefetch(std::uint32_t /*primitive*/) const {}
  /// False where nothing is to be seen: behind the near plane. s ∈ [0, curve.end].
  virtual bool at(StrandCurve& curve, float s, CurvePoint& point) const = 0;
  /// Parameter by which the strand moves on while it covers `pixels` at `depth`, would it lie across the view: Δu₀ of Huang
  /// 2025, eq. 6, as a step of s.
  virtual float step(StrandCurve& curve, float s, float depth, float pixels) const = 0;

  /// The primitive at s, and t on it.
  static std::uint32_t primitive_at(const StrandCurve& curve, float s, float& t) {
    const float whole = s < curve.end ? static_cast<float>(static_cast<std::uint32_t>(s)) : (curve.end > 1 ? curve.end - 1 : 0);
    t = s - whole;
    return curve.first_primitive + static_cast<std::uint32_t>(whole);
  }
};

/// The strands of a scene's grooms, seen by `view`. Refers to the scene.
class GroomCurves final : public StrandCurves {
 public:
  GroomCurves(const Scene& scene, const CameraView& view);
  StrandCurve curve_of(std::uint32_t primitive) const override;
  void prefetch(std::uint32_t primitive) const override;
  bool at(StrandCurve& curve, float s, CurvePoint& point) const override;
  float step(StrandCurve& curve, float s, float depth, float pixels) const override;

 private:
  /// Its control points in camera space.
  void load(StrandCurve& curve, std::uint32_t span) const;

  const Scene* scene_;
  CameraView view_;
  SegmentNumbering spans_;  // one segment a span: its ids are the primitives
};

}  // namespace pelage
