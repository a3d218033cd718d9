// Thick hairs as rays meet them: tubes of elliptical cross-section with fibers at random places in them. From every side they are
// the bundle of docs/derivations/aggregated_scattering.md: a ray passes unless one of n fibers lies on its way.
#pragma once

#include <pelage/scene.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/ray.h"

namespace pelage {

/// Straight pieces of a tube for each span of its curve.
inline constexpr std::uint32_t kThickTessellation = 4;

/// A bundle at one place of a thick hair, world space, metres.
struct ThickPlace {
  Vec3 axis, tangent;  ///< of the tube; unit length, root to tip
  Vec3 major, minor;   ///< semi-axes of the section
  float fibers = 1;    ///< n_total
  float radius = 0;    ///< of one fiber
  float spread = 0;    ///< radians², ThickSections::spreads
  float twist = 0;     ///< radians a metre, ThickSections::twists

  /// Mean direction of the fibers at `met`, a place in the bundle: twisted ones wind about the axis. Unit length.
  Vec3 fiber_tangent(Vec3 met) const { return normalize(tangent + cross(tangent, met - axis) * twist); }
  /// Radians², variance of their directions about that, along each axis: what of `spread` is no twist of an evenly filled ellipse.
  float fiber_spread() const {
    return std::max(spread - 0.125f * twist * twist * (dot(major, major) + dot(minor, minor)), 0.f);
  }
};

/// All thick hairs of a groom with GroomInstance::sections, world space. Queries are const and thread-safe.
///
/// Pieces are elliptical cylinders between two planes, which they share with their neighbors in the hair: no place is in two of them, and
/// bends leave no gap.
class ThickCurves {
 public:
  /// Sections follow the strands' Catmull-Rom curves, straight from control point to control point.
  explicit ThickCurves(const GroomInstance& groom);

  std::size_t piece_count() const { return part_of_.size(); }
  std::size_t span_count() const { return piece_count() / kThickTessellation; }
  std::size_t bytes() const;
  Bounds bounds(std::size_t piece) const;
  /// A ball that holds a piece: center and radius.
  Vec4 ball(std::size_t piece) const;

  std::uint32_t strand(std::size_t piece) const { return part(piece).drawn.strand; }
  /// The piece's place in its strand: pieces from the root.
  std::uint32_t number(std::size_t piece) const {
    return part(piece).drawn.first_span * kThickTessellation + static_cast<std::uint32_t>(piece - part(piece).first_piece);
  }
  /// Pieces of the whole strand.
  std::uint32_t pieces_of_strand(std::size_t piece) const { return part(piece).spans_of_strand * kThickTessellation; }

  /// Where a ray first meets one of the piece's fibers, which lie at random as u ∈ [0, 1) says; none: it passes. The share of u that
  /// passes is (1 − p)ⁿ, p the chance of one fiber to lie on the way: exact for fibers that are spread evenly where the ellipse
  /// has room for them, for a single one too.
  std::optional<float> meet(std::size_t piece, const Ray& ray, float u) const;
  /// How far a ray from within the piece goes until it is out of its hair; what bundles scatter has met all of their fibers.
  float way_out(std::size_t piece, Vec3 origin, Vec3 direction) const;
  /// share ∈ [0, 1]: along the piece, from its root's side. Color and groom do not matter.
  ThickPlace place(std::size_t piece, float share) const;
  /// Of a place along the piece.
  float share_along(std::size_t piece, Vec3 p) const;

 private:
  /// A cross-section between two pieces.
  struct Ring {
    Vec3 center, tangent, major, minor;
    float fibers, diameter, spread, twist;
  };
  struct Chord {
    float near, far;
    int leaves;  // through which end: −1 toward the root, 1 toward the tip, 0 through the side
    float one;   // chance of one fiber to lie on the line, per unit of the ray
  };

  /// What is drawn of a strand.
  struct Part {
    StrandPart drawn;
    std::uint32_t spans_of_strand;
    std::size_t first_piece;
  };

  void add_part(const GroomInstance& groom, const StrandPart& part);
  std::optional<Chord> chord(std::size_t piece, Vec3 origin, Vec3 direction) const;
  const Part& part(std::size_t piece) const { return parts_[part_of_[piece]]; }
  const Ring& ring(std::size_t piece) const { return rings_[piece + part_of_[piece]]; }  // a part has one more than pieces

  std::vector<Ring> rings_;
  std::vector<std::uint32_t> part_of_;  // [pieces]
  std::vector<Part> parts_;
};

}  // namespace pelage
