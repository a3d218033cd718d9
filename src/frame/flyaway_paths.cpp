// flyaway_paths(): strands walked on the screen in steps of half a pixel, and cut where they are hidden or not alone.
#include <pelage/metrics.h>
#include <pelage/render.h>

#include <algorithm>
#include <array>

#include "core/mesh_tracer.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "frame/curve_basis.h"
#include "frame/segment_lookup.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

constexpr std::size_t kStrandsPerTask = 128;
constexpr float kSurfaceMargin = 1e-4f;  // of the depth: what lies on a surface is in front of it

struct Place {
  Vec2 screen;  // pixels
  float depth;  // camera z, metres
};

/// Places at equal distances along a polyline that comes point by point.
class EvenSteps {
 public:
  /// Begins a new polyline.
  void lift() { drawing_ = false; }

  template <class Emit>
  void line_to(Place end, const Emit& emit) {
    if (drawing_) walk_to(end, emit);
    else emit(end), next_ = FlyawayPaths::kStep, drawing_ = true;
    from_ = end;
  }

 private:
  template <class Emit>
  void walk_to(Place end, const Emit& emit) {
    const Vec2 way = end.screen - from_.screen;
    const float l = length(way);
    for (; next_ < l; next_ += FlyawayPaths::kStep) {
      const float t = next_ / l;
      emit(Place{from_.screen + way * t, from_.depth + (end.depth - from_.depth) * t});
    }
    next_ -= l;
  }

  Place from_{};
  float next_ = 0;  // pixels from `from_` to the next place
  bool drawing_ = false;
};

/// Paths of the strands of one task.
struct Parts {
  std::vector<Vec2> places;
  std::vector<std::uint32_t> lengths;
};

class PathFinder {
 public:
  PathFinder(const Scene& scene, float most_coverage, float least_length, const Progress& progress)
      : scene_(scene), view_(make_camera_view(scene.camera, scene.settings.width, scene.settings.height)),
        meshes_(scene.meshes), most_coverage_(most_coverage),
        least_places_(static_cast<std::size_t>(std::ceil(least_length / FlyawayPaths::kStep)) + 1) {
    Scene covered = scene;
    covered.settings.view = View::kCoverage, covered.settings.method = Method::kMsaa, covered.settings.samples = 1;
    coverage_ = render(covered, progress).linear;
  }

  /// Adds the parts of strand `strand` of `groom`; `scratch` is only there to be reused.
  void add(const GroomInstance& groom, std::uint32_t strand, std::vector<Place>& scratch, Parts& out) const {
    scratch.clear();
    EvenSteps steps;
    const auto keep = [&](Place p) {
      if (alone(p.screen)) scratch.push_back(p);
      else end_part(scratch, out);
    };
    const StrandSet& set = *groom.strands;
    const std::uint32_t spans = span_count(set.basis, set.offsets[strand + 1] - set.offsets[strand]);
    for (std::uint32_t span = 0; span < spans; ++span) walk_span(groom, strand, span, steps, keep);
    end_part(scratch, out);
  }

 private:
  template <class Keep>
  void walk_span(const GroomInstance& groom, std::uint32_t strand, std::uint32_t span, EvenSteps& steps,
                 const Keep& keep) const {
    Vec3 p[4];
    span_points(*groom.strands, strand, span, p);
    for (Vec3& q : p) q = transform_point(view_.world_to_camera, transform_point(groom.transform, q));
    const CurveBasis basis = groom.strands->basis;
    const auto at = [&](float t) { return kernel::curve_combine(basis_weights(basis, t), p[0], p[1], p[2], p[3]); };
    const int chords = chords_of(at(0), at(1));
    for (int i = span == 0 ? 0 : 1; i <= chords; ++i) {
      const Vec3 c = at(static_cast<float>(i) / static_cast<float>(chords));
      // What is behind the eye, or far outside the picture, ends a part like what is hidden.
      const Vec2 screen = c.z >= view_.near_plane ? project(view_, c) : Vec2(-1e9f, 0);
      if (near_picture(screen)) steps.line_to({screen, c.z}, keep);
      else keep({{-1, -1}, 0}), steps.lift();
    }
  }

  /// So many that none is much longer than a pixel, and that bends within a span are followed.
  int chords_of(Vec3 a, Vec3 b) const {
    if (!(a.z >= view_.near_plane) || !(b.z >= view_.near_plane)) return 4;
    const float pixels = length(project(view_, b) - project(view_, a));
    return 4 + static_cast<int>(std::min(pixels, 252.f));
  }

  bool near_picture(Vec2 p) const {
    const auto within = [](float x, int size) { return x > -static_cast<float>(size) && x < 2 * static_cast<float>(size); };
    return within(p.x, view_.width) && within(p.y, view_.height);
  }

  bool alone(Vec2 p) const {
    if (!(p.x >= 0 && p.y >= 0)) return false;
    const int x = static_cast<int>(p.x), y = static_cast<int>(p.y);
    if (x >= view_.width || y >= view_.height) return false;
    const float covered = *coverage_.at(x, y);
    return covered > 0 && covered < most_coverage_;
  }

  /// Cuts what was kept where meshes hide it, and hands on what is long enough.
  void end_part(std::vector<Place>& places, Parts& out) const {
    std::array<Ray, MeshTracer::kPacket> rays;
    std::array<bool, MeshTracer::kPacket> hidden{};
    std::size_t begin = 0;
    if (places.size() >= least_places_ && !meshes_.empty())
      for (std::size_t first = 0; first < places.size(); first += rays.size()) {
        const std::size_t n = std::min(rays.size(), places.size() - first);
        for (std::size_t i = 0; i < n; ++i) {
          const Place& p = places[first + i];
          rays[i] = camera_ray(view_, p.screen.x, p.screen.y);
          rays[i].far = p.depth * (1 - kSurfaceMargin);
        }
        meshes_.occluded(std::span(rays).first(n), std::span(hidden).first(n));
        for (std::size_t i = 0; i < n; ++i)
          if (hidden[i]) hand_on(places, begin, first + i, out), begin = first + i + 1;
      }
    hand_on(places, begin, places.size(), out);
    places.clear();
  }

  void hand_on(const std::vector<Place>& places, std::size_t begin, std::size_t end, Parts& out) const {
    if (end < begin + least_places_) return;
    for (std::size_t i = begin; i < end; ++i) out.places.push_back(places[i].screen);
    out.lengths.push_back(static_cast<std::uint32_t>(end - begin));
  }

  const Scene& scene_;
  CameraView view_;
  MeshTracer meshes_;
  Image coverage_;
  float most_coverage_;
  std::size_t least_places_;
};

void append(const Parts& parts, FlyawayPaths& paths) {
  paths.places.insert(paths.places.end(), parts.places.begin(), parts.places.end());
  for (const std::uint32_t length : parts.lengths) paths.offsets.push_back(paths.offsets.back() + length);
}

}  // namespace

FlyawayPaths flyaway_paths(const Scene& scene, float most_coverage, float least_length, const Progress& progress) {
  const PathFinder finder(scene, most_coverage, least_length, progress);
  FlyawayPaths paths{.width = scene.settings.width, .height = scene.settings.height};
  for (const GroomInstance& groom : scene.grooms) {
    const std::size_t strands = groom.strands->strand_count();
    std::vector<Parts> of_task((strands + kStrandsPerTask - 1) / kStrandsPerTask);
    parallel_for(strands, kStrandsPerTask, [&](std::size_t first, std::size_t last) {
      std::vector<Place> scratch;
      for (std::size_t i = first; i < last; ++i)
        finder.add(groom, static_cast<std::uint32_t>(i), scratch, of_task[first / kStrandsPerTask]);
    });
    for (const Parts& parts : of_task) append(parts, paths);
  }
  return paths;
}

}  // namespace pelage
