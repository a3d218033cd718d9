#include "frame/ways_back.h"

#include <algorithm>
#include <array>

#include "core/check.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "frame/reproject.h"
#include "frame/segment_lookup.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 8;
constexpr int kReach = 2;  // pixels

class WayFinder {
 public:
  WayFinder(const FrameInputs& inputs, const Buffer<PixelKey>& keys, const Buffer<float>& depth)
      : in_(inputs), keys_(keys), depth_(depth) {
    for (std::size_t m = 0; m < in_.scene.meshes.size(); ++m)
      back_.push_back(compose(in_.before->meshes[m].transform, inverse_of_similarity(in_.scene.meshes[m].transform)));
  }

  Vec3 at(int x, int y) const {
    const std::size_t p = index(x, y);
    const Vec2 center(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    if (keys_[p] != kEmptyPixel) return of_strand(static_cast<std::uint32_t>(keys_[p]), center);
    if (!std::isinf(depth_[p])) return of_mesh(center);
    const std::size_t near = nearest_around(x, y);
    if (near == p) return {};
    return at(static_cast<int>(near % width()), static_cast<int>(near / width()));
  }

 private:
  std::size_t width() const { return static_cast<std::size_t>(in_.view.width); }
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width() + static_cast<std::size_t>(x); }

  Vec3 of_strand(std::uint32_t id, Vec2 place) const {
    const SegmentRef s = find_segment(in_.scene, in_.numbering, id);
    const float t = locate_on_segment(in_.scene, in_.numbering, in_.view, s, place.x, place.y);
    return surface_at(*in_.before, in_.numbering, s, t).position - surface_at(in_.scene, in_.numbering, s, t).position;
  }

  Vec3 of_mesh(Vec2 place) const {
    const Ray ray = camera_ray(in_.view, place.x, place.y);
    RayHit hit;
    in_.meshes.trace({&ray, 1}, {&hit, 1});
    if (hit.mesh == RayHit::kNone) return {};
    const Vec3 here = ray.origin + ray.direction * hit.distance;
    return transform_point(back_[hit.mesh], here) - here;
  }

  std::size_t nearest_around(int x, int y) const {
    std::size_t best = index(x, y);
    for (int j = std::max(0, y - kReach); j <= std::min(in_.view.height - 1, y + kReach); ++j)
      for (int i = std::max(0, x - kReach); i <= std::min(in_.view.width - 1, x + kReach); ++i)
        if (depth_[index(i, j)] < depth_[best]) best = index(i, j);
    return best;
  }

  const FrameInputs& in_;
  const Buffer<PixelKey>& keys_;
  const Buffer<float>& depth_;
  std::vector<Affine> back_;  // of each mesh, from now to before
};

}  // namespace

Buffer<Vec3> ways_back(const FrameInputs& inputs, const Buffer<PixelKey>& keys, const Buffer<float>& depth) {
  PELAGE_CHECK(inputs.before && keys.size() == depth.size());
  const WayFinder finder(inputs, keys, depth);
  Buffer<Vec3> ways(depth.size());
  parallel_for(static_cast<std::size_t>(inputs.view.height), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    const int width = inputs.view.width;
    for (int y = static_cast<int>(first); y < static_cast<int>(last); ++y)
      for (int x = 0; x < width; ++x)
        ways[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] = finder.at(x, y);
  });
  return ways;
}

}  // namespace pelage
