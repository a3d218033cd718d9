#include "filter/sample_curves.h"

#include <fmt/format.h>
#include <pelage/error.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kStrandsPerTask = 256, kPixelsPerTask = 1 << 14;
constexpr float kSideBySide = 0.7f;              // pixels along the strand: nearer samples are one knot
constexpr float kSameDirection = 0.9f;           // cosine of those that side by side have
constexpr float kMostCameraError = 4;            // pixels
constexpr std::uint32_t kMostPrimitives = 4096;  // of a strand
constexpr float kClose = 4;                      // pixels between samples whose chord has the direction of the strand
constexpr float kFarOutside = 1e6f;              // pixels: what is not in the picture, and still a pixel's number
constexpr float kAgreed = 0.9f;                  // share of chords that speaks for a convention

/// Cubic Hermite curve and its derivative at t ∈ [0, 1].
Vec3 hermite(Vec3 p, Vec3 m, Vec3 q, Vec3 n, float t) {
  const float t2 = t * t, t3 = t2 * t;
  return p * (2 * t3 - 3 * t2 + 1) + m * (t3 - 2 * t2 + t) + q * (3 * t2 - 2 * t3) + n * (t3 - t2);
}
Vec3 hermite_derivative(Vec3 p, Vec3 m, Vec3 q, Vec3 n, float t) {
  const float t2 = t * t;
  return (p - q) * (6 * t2 - 6 * t) + m * (3 * t2 - 4 * t + 1) + n * (3 * t2 - 2 * t);
}

/// Length of the Hermite tangents over that of the chord, so that two places on a circle are joined as by Bézier's approximation of
/// its arc: 1/cos²(θ/4), where the directions differ by θ. Directions that nobody knows count as that of the chord.
float tangent_scale(Vec3 m, Vec3 n) {
  if (dot(m, m) == 0 || dot(n, n) == 0) return 1;
  const float cos_half = std::sqrt(std::max(0.f, (1 + dot(m, n)) / 2));
  return 2 / (1 + cos_half);
}

float median(std::vector<float>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

/// What building needs beside what stays.
struct SampleCurves::Maker {
  SampleCurves& curves;
  const HairSamples& samples;
  std::vector<std::uint32_t> pixels;       // of hair: by strand, then u
  std::vector<std::uint32_t> first_pixel;  // of each strand in `pixels`; one more
  std::vector<float> direction;            // of each in `pixels`: 1, or −1 where its tangent points to the root

  Vec2 screen_of(std::uint32_t pixel) const {
    const auto width = static_cast<std::uint32_t>(samples.width);
    return {static_cast<float>(pixel % width) + 0.5f, static_cast<float>(pixel / width) + 0.5f};
  }

  void sort_pixels() {
    for (std::size_t p = 0; p < samples.strand.size(); ++p)
      if (samples.is_hair(p)) pixels.push_back(static_cast<std::uint32_t>(p));
    std::sort(pixels.begin(), pixels.end(), [&](std::uint32_t a, std::uint32_t b) {
      const std::uint64_t ka = samples.strand_key(a), kb = samples.strand_key(b);
      if (ka != kb) return ka < kb;
      return samples.u[a] != samples.u[b] ? samples.u[a] < samples.u[b] : a < b;
    });
    for (std::size_t i = 0; i < pixels.size(); ++i)
      if (i == 0 || samples.strand_key(pixels[i]) != samples.strand_key(pixels[i - 1]))
        first_pixel.push_back(static_cast<std::uint32_t>(i));
    first_pixel.push_back(static_cast<std::uint32_t>(pixels.size()));
  }
  std::size_t strand_count() const { return first_pixel.size() - 1; }

  void fit() {
    if (samples.on_screen || pixels.empty()) return;
    std::vector<Vec3> positions;
    std::vector<Vec2> screen;
    for (const std::uint32_t p : pixels) positions.push_back(samples.position[p]), screen.push_back(screen_of(p));
    curves.camera_ = fit_camera(positions, screen);
    double square = 0;
    ProjectiveCamera::Seen seen;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Vec2 off = curves.camera_.see(positions[i], seen) ? seen.screen - screen[i] : Vec2(1e4f, 1e4f);
      square += static_cast<double>(dot(off, off));
    }
    const auto error = static_cast<float>(std::sqrt(square / static_cast<double>(positions.size())));
    curves.camera_error_ = error;
    if (!(error <= kMostCameraError))
      throw Error(
          "G-buffer", "position",
          fmt::format("no camera sees hair at these places where it is in the picture: they are {:.1f} pixels apart", error),
          "render one sample a pixel without a filter over pixels, lens or shutter; or give `screen` instead of `tangent`");
  }

  /// From sample i to the one after it, where that is close on the same strand; else 0.
  Vec3 chord_from(std::size_t i) const {
    if (i + 1 >= pixels.size() || samples.strand_key(pixels[i]) != samples.strand_key(pixels[i + 1])) return {};
    const Vec2 gap = screen_of(pixels[i + 1]) - screen_of(pixels[i]);
    if (dot(gap, gap) > kClose * kClose || samples.u[pixels[i]] == samples.u[pixels[i + 1]]) return {};
    return samples.position[pixels[i + 1]] - samples.position[pixels[i]];
  }

  /// Where chords of close samples agree that tangents point one way, they do; else each follows its own chord.
  void turn_tangents() {
    direction.assign(pixels.size(), 1);
    std::size_t chords = 0, toward_root = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      Vec3 chord = chord_from(i);
      if (chord == Vec3() && i > 0) chord = chord_from(i - 1);
      const float along = dot(samples.tangent[pixels[i]], chord);
      if (along < 0) direction[i] = -1, ++toward_root;
      chords += along != 0;
    }
    const float share = static_cast<float>(toward_root) / static_cast<float>(std::max<std::size_t>(1, chords));
    if (share <= 1 - kAgreed) direction.assign(pixels.size(), 1);
    if (share >= kAgreed) direction.assign(pixels.size(), -1);
  }

  Vec3 tangent_of(std::size_t i) const { return normalize(samples.tangent[pixels[i]] * direction[i]); }

  Vec2 screen_tangent(std::size_t i) const {
    const Vec2 along = curves.camera_.move(samples.position[pixels[i]], tangent_of(i));
    const float pixels_long = length(along);
    return pixels_long > 0 && std::isfinite(pixels_long) ? along * (1 / pixels_long) : Vec2();
  }

  /// Samples of a strand that lie side by side, as those of one wider than a pixel do, become one knot.
  void add_knots(std::size_t strand, std::vector<Knot>& knots) const {
    for (std::size_t i = first_pixel[strand]; i < first_pixel[strand + 1];) {
      const Vec3 start = samples.position[pixels[i]], along = tangent_of(i);
      const float unit = curves.camera_.pixels_per_unit(start);
      Knot sum{0, 0, {}, {}};
      float count = 0;
      for (; i < first_pixel[strand + 1]; ++i, ++count) {
        const std::uint32_t p = pixels[i];
        const Vec3 gap = (samples.position[p] - start) * unit;
        const bool beside = std::fabs(dot(gap, along)) <= kSideBySide && dot(gap, gap) <= kClose * kClose;
        if (count > 0 && !(beside && dot(tangent_of(i), along) >= kSameDirection)) break;
        sum.u += samples.u[p], sum.depth += samples.depth[p];
        sum.position += samples.position[p], sum.tangent += tangent_of(i);
      }
      knots.push_back({std::clamp(sum.u / count, 0.f, 1.f), sum.depth / count, sum.position / count, normalize(sum.tangent)});
    }
  }

  void make_strands() {
    const std::size_t count = strand_count(), tasks = (count + kStrandsPerTask - 1) / kStrandsPerTask;
    std::vector<std::vector<Knot>> knots(tasks);
    curves.strands_.resize(count);
    parallel_for(count, kStrandsPerTask, [&](std::size_t begin, std::size_t end) {
      std::vector<Knot>& mine = knots[begin / kStrandsPerTask];
      for (std::size_t s = begin; s < end; ++s) {
        const std::size_t first = mine.size();
        add_knots(s, mine);
        float way = 0;
        for (std::size_t k = first + 1; k < mine.size(); ++k) way += length(mine[k].position - mine[k - 1].position);
        const float du = mine.back().u - mine[first].u;
        curves.strands_[s] = {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(mine.size()), 0, 0,
                              du > 1e-4f && way > 0 ? way / du : 0};
      }
    });
    for (std::size_t t = 0; t < tasks; ++t) {
      const auto before = static_cast<std::uint32_t>(curves.knots_.size());
      for (std::size_t s = t * kStrandsPerTask; s < std::min(count, (t + 1) * kStrandsPerTask); ++s)
        curves.strands_[s].first_knot += before, curves.strands_[s].knot_end += before;
      curves.knots_.insert(curves.knots_.end(), knots[t].begin(), knots[t].end());
    }
  }

  /// Strands of a single knot are as long as the others. Then every strand has its primitives.
  void number_primitives() {
    std::vector<float> speeds;
    for (const Strand& s : curves.strands_)
      if (s.speed > 0) speeds.push_back(s.speed);
    const float usual = median(speeds);
    const auto room =
        VisibilitySample::kMaxPrimitive / static_cast<std::uint32_t>(std::max<std::size_t>(1, curves.strands_.size()));
    if (room == 0) throw Error("G-buffer", "strand", "more strands than 30 bits can name", "denoise the picture in parts");
    std::uint32_t next = 0;
    for (Strand& s : curves.strands_) {
      const Vec3 where = curves.knots_[s.first_knot].position;
      const float unit = curves.camera_.pixels_per_unit(where);
      if (!(s.speed > 0)) s.speed = usual > 0 ? usual : static_cast<float>(samples.width + samples.height) / unit;
      const float pieces = s.speed * unit / curves.settings_.piece + 0.5f;
      s.primitives = pieces >= 1 ? static_cast<std::uint32_t>(std::min(pieces, static_cast<float>(kMostPrimitives))) : 1;
      s.primitives = std::min(s.primitives, room);
      s.first_primitive = next;
      curves.first_primitive_.push_back(next);
      next += s.primitives;
    }
  }

  void fill_visibility() {
    curves.visibility_.resize(samples.strand.size());
    parallel_for(curves.visibility_.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
      std::fill(curves.visibility_.begin() + begin, curves.visibility_.begin() + end, VisibilitySample());
    });
    parallel_for(strand_count(), kStrandsPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) {
        const Strand& strand = curves.strands_[s];
        StrandCurve curve = curves.curve_of(strand.first_primitive);
        for (std::size_t i = first_pixel[s]; i < first_pixel[s + 1]; ++i) {
          float t = 0;
          const std::uint32_t primitive = primitive_at(curve, std::clamp(samples.u[pixels[i]], 0.f, 1.f) * curve.end, t);
          curves.visibility_[pixels[i]] = pack_visibility(screen_tangent(i), t, primitive, false);
        }
      }
    });
  }
};

SampleCurves::SampleCurves(const HairSamples& samples, const SampleCurveSettings& settings) : settings_(settings) {
  Maker maker{*this, samples, {}, {}, {}};
  maker.sort_pixels();
  maker.fit();
  maker.turn_tangents();
  maker.make_strands();
  maker.number_primitives();
  maker.fill_visibility();
}

StrandCurve SampleCurves::curve_of(std::uint32_t primitive) const {
  const auto next = std::upper_bound(first_primitive_.begin(), first_primitive_.end(), primitive);
  const auto strand = static_cast<std::uint32_t>(next - first_primitive_.begin() - 1);
  return {first_primitive_[strand], 0, strand, static_cast<float>(strands_[strand].primitives)};
}

bool SampleCurves::place(const Strand& strand, float u, Place& place) const {
  const Knot *const first = knots_.data() + strand.first_knot, *const end = knots_.data() + strand.knot_end;
  const Knot* const next = std::upper_bound(first, end, u, [](float value, const Knot& k) { return value < k.u; });
  if (next == first || next == end) {
    const Knot& last = next == first ? *first : end[-1];
    const float ahead = (u - last.u) * strand.speed;
    place = {last.position + last.tangent * ahead, last.tangent, last.depth, strand.speed};
    return std::fabs(ahead) * camera_.pixels_per_unit(last.position) <= settings_.reach;
  }
  const Knot &a = next[-1], &b = *next;
  const float du = b.u - a.u, t = (u - a.u) / du;
  const Vec3 chord = b.position - a.position;
  const float scale = length(chord) * tangent_scale(a.tangent, b.tangent);
  const Vec3 m = dot(a.tangent, a.tangent) > 0 ? a.tangent * scale : chord,
             n = dot(b.tangent, b.tangent) > 0 ? b.tangent * scale : chord;
  place.position = hermite(a.position, m, b.position, n, t);
  place.tangent = normalize(hermite_derivative(a.position, m, b.position, n, t));
  place.depth = a.depth + (b.depth - a.depth) * t;
  place.speed = length(chord) / du;
  return true;
}

bool SampleCurves::at(StrandCurve& curve, float s, CurvePoint& point) const {
  Place here;
  if (!place(strands_[curve.strand], s / curve.end, here)) return false;
  ProjectiveCamera::Seen seen;
  if (!camera_.see(here.position, seen) || !(dot(seen.screen, seen.screen) < kFarOutside * kFarOutside)) return false;
  const Vec2 along = camera_.move(here.position, here.tangent);
  const float pixels = length(along);
  point.screen = seen.screen;
  point.depth = here.depth;
  point.tangent = pixels > 0 ? along * (1 / pixels) : Vec2();
  return true;
}

float SampleCurves::step(StrandCurve& curve, float s, float, float pixels) const {
  Place here;
  place(strands_[curve.strand], s / curve.end, here);
  const float across = here.speed * camera_.pixels_per_unit(here.position);
  return across > 0 ? pixels * curve.end / across : 1;
}

}  // namespace pelage
