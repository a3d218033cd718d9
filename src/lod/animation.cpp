// A scene at one frame of its animations.
#include <pelage/animation.h>
#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "frame/camera_view.h"

namespace pelage {
namespace {

/// Whether the map turns and moves without scaling, to rounding.
bool is_rigid(const Affine& a) {
  constexpr float kRounding = 1e-3f;
  for (const auto& row : a.m)
    for (const float x : row)
      if (!std::isfinite(x)) return false;
  const auto row = [&](int i) { return Vec3(a.m[i][0], a.m[i][1], a.m[i][2]); };
  for (int i = 0; i < 3; ++i) {
    if (std::fabs(length(row(i)) - 1) > kRounding) return false;
    if (std::fabs(dot(row(i), row((i + 1) % 3))) > kRounding) return false;
  }
  return dot(cross(row(0), row(1)), row(2)) > 0;
}

const GuideAnimation* animation_of(const GroomInstance& groom) {
  return groom.lod && groom.strands ? groom.lod->animation.get() : nullptr;
}

void move_hair(std::span<const Vec3> guides, GroomInstance& groom) {
  auto lod = std::make_shared<LodHierarchy>(*groom.lod);
  ThickHairPose pose;
  pose_hairs(*groom.lod, guides, pose);
  lod->centers = std::move(pose.centers), lod->major = std::move(pose.major), lod->minor = std::move(pose.minor);
  groom.strands = std::make_shared<StrandSet>(pose_strands(*groom.lod, *groom.strands, guides));
  groom.lod = std::move(lod);
}

}  // namespace

std::size_t GuideAnimation::index_of(int frame) const {
  return static_cast<std::size_t>(std::clamp(frame, first_frame, last_frame()) - first_frame);
}

void validate(const GuideAnimation& a, std::size_t guides, const std::string& where) {
  const auto require = [&](bool sound, const char* place, const std::string& problem) {
    if (!sound) throw Error(where, place, problem, "simulate it again: pelage simulate");
  };
  require(a.frame_rate >= 1 && a.frame_rate <= 1000, "animation", fmt::format("{} frames a second", a.frame_rate));
  require(a.first_frame >= -1000000 && a.first_frame <= 1000000, "animation",
          fmt::format("its first frame is {}", a.first_frame));
  require(a.frames() >= 1 && a.frames() <= GuideAnimation::kMostFrames, "animation", fmt::format("{} frames", a.frames()));
  require(guides > 0 && a.guides.size() == a.frames() * guides * LodHierarchy::kPoints, "animation",
          fmt::format("{} control points for {} frames of {} guides", a.guides.size(), a.frames(), guides));
  for (std::size_t i = 0; i < a.guides.size(); ++i)
    require(is_finite(a.guides[i]) && std::fabs(a.guides[i].x) <= kMaxCoordinate &&
                std::fabs(a.guides[i].y) <= kMaxCoordinate && std::fabs(a.guides[i].z) <= kMaxCoordinate,
            "animation", fmt::format("control point {} is not finite", i));
  for (std::size_t f = 0; f < a.frames(); ++f)
    require(is_rigid(a.head[f]), "animation", fmt::format("the head of frame {} is neither turned nor moved", f));
}

std::optional<FrameRange> animated_frames(const Scene& scene) {
  std::optional<FrameRange> all;
  for (const GroomInstance& groom : scene.grooms)
    if (const GuideAnimation* a = animation_of(groom)) {
      const FrameRange own{a->first_frame, a->last_frame()};
      all = all ? FrameRange{std::min(all->first, own.first), std::max(all->last, own.last)} : own;
    }
  return all;
}

Scene at_frame(const Scene& rest, int frame, bool still_meshes) {
  Scene scene = rest;
  bool meshes_moved = still_meshes;
  for (GroomInstance& groom : scene.grooms) {
    const GuideAnimation* animation = animation_of(groom);
    if (!animation) continue;
    const std::size_t index = animation->index_of(frame);
    if (!meshes_moved) {
      const Affine head = compose(groom.transform, compose(animation->head[index], inverse_of_similarity(groom.transform)));
      for (MeshInstance& mesh : scene.meshes) mesh.transform = compose(head, mesh.transform);
      meshes_moved = true;
    }
    const std::shared_ptr<const LodHierarchy> keep = groom.lod;  // while its animation is read
    move_hair(animation->guides_at(index), groom);
  }
  return scene;
}

}  // namespace pelage
