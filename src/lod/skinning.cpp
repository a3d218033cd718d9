// Guides move; hairs and strands follow (Huang 2025, section 5.1, step 4, after Somasundaram 2015; references.bib:
// Somasundaram2015Interpolation). A place x that belongs to control point k moves to
//
//   x′ = Σ w_i·g′_i[k] + R[k]·(x − Σ w_i·g_i[k]),
//
// w_i its shares of the three guides of its prism and R[k] the rotation of the prism's edges about control point k. The shares
// carry what guides do differently, the rotation what lies outside their triangle: nothing is stored for single points of strands.
#include <pelage/error.h>
#include <pelage/lod.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/parallel.h"
#include "frame/curve_basis.h"
#include "lod/rotation.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;

/// One prism at rest and in the pose.
struct PosedPrism {
  const Vec3* rest[3];
  const Vec3* moved[3];
  std::array<Rotation, kPoints> turn;

  Vec3 base(const Vec3* const (&guides)[3], Vec2 w, std::size_t k) const {
    return guides[0][k] * w.x + guides[1][k] * w.y + guides[2][k] * (1 - w.x - w.y);
  }
  /// Of weights that sum to zero.
  Vec3 difference(const Vec3* const (&guides)[3], Vec2 w, std::size_t k) const {
    return (guides[0][k] - guides[2][k]) * w.x + (guides[1][k] - guides[2][k]) * w.y;
  }
};

PosedPrism pose_prism(const LodHierarchy& lod, std::span<const Vec3> guides, std::size_t prism) {
  PosedPrism p;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t at = lod.prisms[prism][i] * kPoints;
    p.rest[i] = &lod.guides[at], p.moved[i] = &guides[at];
  }
  for (std::size_t k = 0; k < kPoints; ++k) {
    std::array<Vec3, 9> rest, moved;
    std::size_t count = 0;
    for (std::size_t j = k > 0 ? k - 1 : 0; j <= std::min(k + 1, kPoints - 1); ++j)
      for (std::size_t i = 0; i < 3; ++i, ++count) rest[count] = p.rest[i][j], moved[count] = p.moved[i][j];
    p.turn[k] = best_rotation({rest.data(), count}, {moved.data(), count});
  }
  return p;
}

void check_guides(const LodHierarchy& lod, std::span<const Vec3> guides) {
  if (guides.size() != lod.guides.size())
    throw Error("lod", "guides", fmt::format("{} control points", guides.size()),
                fmt::format("there are {} guides of {}", lod.guide_count(), kPoints));
}

/// Strand `s` of `rest` in the pose of its prism. Points go with the place on the guides at their share of the strand's length.
class StrandPoser {
 public:
  explicit StrandPoser(const StrandSet& rest) : rest_(rest) {}

  void pose(const PosedPrism& prism, Vec2 weights, std::size_t s, Vec3* out) {
    const std::size_t first = rest_.offsets[s], count = rest_.offsets[s + 1] - first;
    const Vec3* points = &rest_.points[first];
    measure(points, count);
    std::array<Vec3, kPoints> base, moved;
    for (std::size_t k = 0; k < kPoints; ++k) {
      base[k] = prism.base(prism.rest, weights, k);
      moved[k] = prism.base(prism.moved, weights, k);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const float x = share_[i] * static_cast<float>(kPoints - 1);
      const std::size_t span = std::min(static_cast<std::size_t>(x), kPoints - 2);
      const float t = x - static_cast<float>(span);
      const Vec4 w = basis_weights(CurveBasis::kBSpline, t);
      const Rotation turn = blend(prism.turn[span], prism.turn[span + 1], t);
      out[i] = on_curve(moved, w, span) + turn(points[i] - on_curve(base, w, span));
    }
  }

 private:
  /// Shares of the length up to each point.
  void measure(const Vec3* points, std::size_t count) {
    share_.assign(count, 0);
    for (std::size_t i = 1; i < count; ++i) share_[i] = share_[i - 1] + length(points[i] - points[i - 1]);
    const float total = share_.back();
    for (float& s : share_) s = total > 0 ? s / total : 0;
  }

  static Vec3 on_curve(const std::array<Vec3, kPoints>& control, Vec4 w, std::size_t span) {
    const Vec3 before = span > 0 ? control[span - 1] : control[0] * 2.f - control[1];
    const Vec3 after = span + 2 < kPoints ? control[span + 2] : control[kPoints - 1] * 2.f - control[kPoints - 2];
    return kernel::curve_combine(w, before, control[span], control[span + 1], after);
  }

  const StrandSet& rest_;
  std::vector<float> share_;
};

}  // namespace

void pose_hairs(const LodHierarchy& lod, std::span<const Vec3> guides, ThickHairPose& pose) {
  check_guides(lod, guides);
  pose.centers.resize(lod.centers.size()), pose.major.resize(lod.major.size()), pose.minor.resize(lod.minor.size());
  std::vector<PosedPrism> prisms(lod.prisms.size());
  parallel_for(prisms.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) prisms[p] = pose_prism(lod, guides, p);
  });
  parallel_for(lod.hair_count(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t h = begin; h < end; ++h) {
      const PosedPrism& prism = prisms[lod.hairs[h].prism];
      for (std::size_t k = 0; k < kPoints; ++k) {
        const std::size_t i = h * kPoints + k;
        const Rotation& turn = prism.turn[k];
        const auto axis = [&](Vec3 rest, Vec2 w) {
          return prism.difference(prism.moved, w, k) + turn(rest - prism.difference(prism.rest, w, k));
        };
        pose.centers[i] =
            prism.base(prism.moved, lod.weights[h], k) + turn(lod.centers[i] - prism.base(prism.rest, lod.weights[h], k));
        pose.major[i] = axis(lod.major[i], lod.major_weights[i]);
        pose.minor[i] = axis(lod.minor[i], lod.minor_weights[i]);
      }
    }
  });
}

StrandSet pose_strands(const LodHierarchy& lod, const StrandSet& rest, std::span<const Vec3> guides) {
  check_guides(lod, guides);
  if (rest.strand_count() != lod.strand_count())
    throw Error("lod", "strands", fmt::format("{} of them", rest.strand_count()),
                fmt::format("the hierarchy was built for {}", lod.strand_count()));
  StrandSet posed = rest;
  parallel_for(lod.prisms.size(), 4, [&](std::size_t begin, std::size_t end) {
    StrandPoser poser(rest);
    for (std::size_t p = begin; p < end; ++p) {
      const PosedPrism prism = pose_prism(lod, guides, p);
      const ThickHair& hair = lod.hairs[p];
      for (std::uint32_t i = hair.first_strand; i < hair.first_strand + hair.fibers; ++i) {
        const std::uint32_t s = lod.order[i];
        poser.pose(prism, lod.strand_weights[s], s, &posed.points[rest.offsets[s]]);
      }
    }
  });
  return posed;
}

}  // namespace pelage
