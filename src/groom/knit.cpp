// Knitted cloth: loops of yarn, plies twisted about each other, fibers twisted about the middle of their ply.
//
// In diameters of the yarn a course is the curve
//
//   x = 3.3 s + 0.79 sin 4πs,   y = 2.05 cos 2πs,   z = 0.55 σ (1 − cos 4πs),   s: stitches,
//
// and the next course stands 2.5 higher. At whole s lies the top of a loop, in the middle between two of them the bottom; sideways swings make
// the loop wider at its top than at its foot, so that it holds the next one, and the swings in depth pass each leg in front of the loop
// below and each top behind the legs above. σ is 1 on knit stitches and −1 on purl ones and changes at the bottom between both. The numbers
// were found by search: of stitches of this size those have the largest distance between the middles of yarns, 0.81 diameters. Yarn is soft, and
// where yarns cross in cloth it is pressed flat; here its plies go into one another there by as much.
#include <pelage/knit.h>

#include <algorithm>
#include <cmath>

#include "core/nearest.h"
#include "core/parallel.h"
#include "core/rng.h"
#include "core/shared_progress.h"
#include "groom/check_range.h"
#include "groom/frames.h"
#include "groom/noise.h"
#include "groom/sdf.h"

namespace pelage {
namespace {

using namespace groom;

constexpr float kTwoPi = 6.28318531f;
constexpr float kWale = 3.3f, kCourse = 2.5f, kSwing = 0.79f, kLoop = 2.05f, kDepth = 0.55f;  // diameters of the yarn
constexpr float kTurnOver = 0.3f;  // stitches over which yarn goes from a knit stitch to a purl one
constexpr float kUneven = 5;       // diameters from one unevenness of the cloth to the next
constexpr int kPiecesPerStitch = 2;
constexpr std::uint32_t kPlyStream = 0x706c7900u, kFiberStream = 0x66696272u;

void check(const KnitSettings& s) {
  check_range("strands", s.strands, 1, 1000000);
  check_range("points", s.points, 4, 1024);
  check_range("wales", s.wales, 1, 1000);
  check_range("courses", s.courses, 1, 1000);
  check_range("yarn", s.yarn, 1e-4f, 0.1f);
  check_range("plies", s.plies, 1, 16);
  check_range("ply_pitch", s.ply_pitch, 1, 1000);
  check_range("fiber_pitch", s.fiber_pitch, 1, 1000);
  check_range("packing", s.packing, 0.01f, 1);
  check_range("migration", s.migration, 0, 1);
  check_range("irregularity", s.irregularity, 0, 0.5f);
}

/// A curve with frames across it.
struct Core {
  std::vector<Vec3> position, side, up;
};

/// How many there are of what the patch is made of.
struct Counts {
  std::size_t pieces, plies, fibers;  ///< pieces of a course, plies of a yarn, fibers of a ply
  std::size_t strands_of_course() const { return pieces * plies * fibers; }
};

class Knitter {
 public:
  explicit Knitter(const KnitSettings& settings) : s_(settings) {
    counts_.pieces = static_cast<std::size_t>(s_.wales) * kPiecesPerStitch;
    counts_.plies = static_cast<std::size_t>(s_.plies);
    const std::size_t bundles = counts_.pieces * counts_.plies * static_cast<std::size_t>(s_.courses);
    counts_.fibers = std::max<std::size_t>((static_cast<std::size_t>(s_.strands) + bundles / 2) / bundles, 1);
    check_range("strands × points", static_cast<double>(bundles * counts_.fibers) * s_.points, 4, 4294967295.0);
    // Plies touch each other and fill the yarn: their middles stand at their radius over sin π/n, on that circle, or in the middle.
    const float apart = s_.plies > 1 ? 1 / std::sin(0.5f * kTwoPi / static_cast<float>(s_.plies)) : 0;
    ply_radius_ = 0.5f * s_.yarn / (1 + apart), ply_offset_ = ply_radius_ * apart;
    fiber_radius_ = ply_radius_ * std::sqrt(s_.packing / static_cast<float>(counts_.fibers));
  }

  /// A set of the right size, of which add_course() fills the rest.
  StrandSet empty_patch() const {
    const std::size_t count = counts_.strands_of_course() * static_cast<std::size_t>(s_.courses),
                      points = static_cast<std::size_t>(s_.points);
    StrandSet set;
    set.points.resize(count * points), set.widths = {2 * fiber_radius_};
    set.root_uv.resize(count), set.strand_id.resize(count), set.guide_id.resize(count), set.offsets.resize(count + 1);
    for (std::size_t i = 0; i <= count; ++i) set.offsets[i] = static_cast<std::uint32_t>(i * points);
    return set;
  }

  void add_course(std::size_t course, StrandSet& out) const {
    const Core yarn = along(yarn_positions(course), Vec3(0, 0, 1));
    const std::vector<float> length = lengths(yarn.position);
    const float turned = kTwoPi * Rng(s_.seed, static_cast<std::uint32_t>(course), kPlyStream).uniform();
    for (std::size_t ply = 0; ply < counts_.plies; ++ply) {
      const float phase = turned + kTwoPi * static_cast<float>(ply) / static_cast<float>(counts_.plies);
      const Core core = along(ply_positions(yarn, length, phase), yarn.side[0]);
      for (std::size_t fiber = 0; fiber < counts_.fibers; ++fiber) add_fiber(core, length, course, ply, fiber, out);
    }
  }

 private:
  /// Samples of a course; pieces share their ends.
  std::size_t samples() const { return counts_.pieces * static_cast<std::size_t>(s_.points - 1) + 1; }

  /// 1 on knit stitches, −1 on purl ones.
  float facing(float stitches) const {
    if (s_.pattern == KnitPattern::kStockinette) return 1;
    const auto side = [](float wale) { return std::fmod(wale + 4096, 4.f) < 2 ? 1.f : -1.f; };
    const float wale = std::floor(stitches), at = stitches - wale - 0.5f;
    return mix(side(wale), side(wale + 1), smoothstep(-0.5f * kTurnOver, 0.5f * kTurnOver, at));
  }

  /// The yarn of a course after so many stitches, counted from the top of its first loop. Metres.
  Vec3 yarn_at(std::size_t course, float stitches) const {
    const float turn = kTwoPi * stitches, depth = kDepth * facing(stitches);
    const float middle = 0.5f * static_cast<float>(s_.wales - 1),
                row = static_cast<float>(course) - 0.5f * static_cast<float>(s_.courses - 1);
    const Vec3 p(kWale * (stitches - middle) + kSwing * std::sin(2 * turn), kCourse * row + kLoop * std::cos(turn),
                 depth * (1 - std::cos(2 * turn)));
    // The unevenness is that of the space around the cloth, so neighbors go along with each other.
    const auto seed = static_cast<std::uint32_t>(s_.seed ^ (s_.seed >> 32));
    return (p + noise3_vector(p * (1 / kUneven), seed) * s_.irregularity) * s_.yarn;
  }

  std::vector<Vec3> yarn_positions(std::size_t course) const {
    std::vector<Vec3> p(samples());
    const float step = 1 / static_cast<float>(kPiecesPerStitch * (s_.points - 1));
    for (std::size_t j = 0; j < p.size(); ++j) p[j] = yarn_at(course, static_cast<float>(j) * step - 0.5f);
    return p;
  }

  std::vector<Vec3> ply_positions(const Core& yarn, const std::vector<float>& length, float phase) const {
    std::vector<Vec3> p(samples());
    const float rate = kTwoPi / (s_.ply_pitch * s_.yarn);
    for (std::size_t j = 0; j < p.size(); ++j) p[j] = around(yarn, j, phase + rate * length[j], ply_offset_);
    return p;
  }

  void add_fiber(const Core& ply, const std::vector<float>& length, std::size_t course, std::size_t number, std::size_t fiber,
                 StrandSet& out) const {
    Rng rng(s_.seed, static_cast<std::uint32_t>((course * counts_.plies + number) * counts_.fibers + fiber), kFiberStream);
    const float phase = kTwoPi * rng.uniform(), wander = kTwoPi * rng.uniform();
    const float radius = (ply_radius_ - fiber_radius_) * std::sqrt(rng.uniform());
    const float rate = -kTwoPi / (s_.fiber_pitch * s_.yarn), slow = 0.3f * mix(0.7f, 1.3f, rng.uniform()) * rate;
    const auto points = static_cast<std::size_t>(s_.points);
    for (std::size_t piece = 0; piece < counts_.pieces; ++piece) {
      const std::size_t strand = name_strand(course, piece, number, fiber, out);
      for (std::size_t k = 0; k < points; ++k) {
        const std::size_t j = piece * (points - 1) + k;
        const float inward = s_.migration * 0.5f * (1 + std::sin(wander + slow * length[j]));
        out.points[strand * points + k] = around(ply, j, phase + rate * length[j], radius * (1 - inward));
      }
    }
  }

  /// Everything of a strand but its points; returns where it stands.
  std::size_t name_strand(std::size_t course, std::size_t piece, std::size_t ply, std::size_t fiber, StrandSet& out) const {
    const std::size_t bundle = (course * counts_.pieces + piece) * counts_.plies + ply,
                      bundles = out.strand_count() / counts_.fibers, strand = bundle * counts_.fibers + fiber;
    out.strand_id[strand] = static_cast<std::uint32_t>(fiber * bundles + bundle);
    out.guide_id[strand] = static_cast<std::int32_t>(bundle);
    out.root_uv[strand] = {(static_cast<float>(piece) + 0.5f) / static_cast<float>(counts_.pieces),
                           (static_cast<float>(course) + 0.5f) / static_cast<float>(s_.courses)};
    return strand;
  }

  static Core along(std::vector<Vec3> position, Vec3 normal) {
    Core c{std::move(position), {}, {}};
    c.side.resize(c.position.size()), c.up.resize(c.position.size());
    rotation_minimizing_frames(c.position.data(), static_cast<int>(c.position.size()), normal, c.side.data(), c.up.data());
    return c;
  }

  static Vec3 around(const Core& core, std::size_t j, float angle, float radius) {
    return core.position[j] + (core.side[j] * std::cos(angle) + core.up[j] * std::sin(angle)) * radius;
  }

  static std::vector<float> lengths(const std::vector<Vec3>& p) {
    std::vector<float> length(p.size());
    for (std::size_t j = 1; j < p.size(); ++j) length[j] = length[j - 1] + pelage::length(p[j] - p[j - 1]);
    return length;
  }

  const KnitSettings& s_;
  Counts counts_;
  float ply_radius_, ply_offset_, fiber_radius_;  // metres; the offset is that of a ply's middle from the yarn's
};

}  // namespace

const std::vector<std::string>& knit_pattern_names() {
  static const std::vector<std::string> names{"knit-stockinette", "knit-rib"};
  return names;
}

KnitPattern knit_pattern_from_name(const std::string& name) {
  const std::vector<std::string>& names = knit_pattern_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<KnitPattern>(found - names.begin());
  throw Error("pattern", name, "unknown pattern of knitting", "did you mean \"" + nearest_name(name, names) + "\"?");
}

StrandSet grow_knit(const KnitSettings& settings, const Progress& progress) {
  check(settings);
  const Knitter knitter(settings);
  StrandSet patch = knitter.empty_patch();
  const auto courses = static_cast<std::size_t>(settings.courses);
  SharedProgress shared(progress, "grow", courses);
  parallel_for(courses, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t course = begin; course < end; ++course) knitter.add_course(course, patch);
    shared.add(end - begin);
  });
  return patch;
}

}  // namespace pelage
