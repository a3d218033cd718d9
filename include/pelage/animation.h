// Hair in motion: where guides and head are from frame to frame, and a scene as it stands at one of them.
#pragma once

#include <pelage/lod.h>
#include <pelage/scene.h>
#include <pelage/vec.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pelage {

/// Guides of a LodHierarchy and the head that they grow on, frame by frame. Metres, in the space of the groom at rest.
struct GuideAnimation {
  static constexpr std::uint32_t kMostFrames = 1u << 20;

  float frame_rate = 24;         ///< frames a second, 1…1000
  std::int32_t first_frame = 1;  ///< its number, −10⁶…10⁶
  std::vector<Vec3> guides;      ///< [frames · guide_count · LodHierarchy::kPoints] control points
  std::vector<Affine> head;      ///< [frames] from rest to the frame: a rotation and a translation

  std::size_t frames() const { return head.size(); }
  std::int32_t last_frame() const { return first_frame + static_cast<std::int32_t>(frames()) - 1; }
  /// Index of a frame by its number; before the first it is the first's, after the last the last's.
  std::size_t index_of(int frame) const;
  std::span<const Vec3> guides_at(std::size_t index) const {
    const std::size_t count = guides.size() / frames();
    return {guides.data() + index * count, count};
  }
};

/// Throws Error(`where`, …) naming the first broken rule of GuideAnimation, or of one of `guides` guides. Untrusted-input safe.
void validate(const GuideAnimation& animation, std::size_t guides, const std::string& where);

/// First and last frame that any groom of the scene has an animation for; none where none has.
struct FrameRange {
  int first = 1, last = 1;
};
std::optional<FrameRange> animated_frames(const Scene& scene);

/// `rest` as it stands at frame `frame`: strands and thick hairs of animated grooms follow their guides, and, unless
/// `still_meshes`, all meshes move with the head of the first of them. Before its first and after its last frame a groom keeps that
/// pose. Strands keep their order and their points, so two frames of a scene have the same segments.
Scene at_frame(const Scene& rest, int frame, bool still_meshes = false);

}  // namespace pelage
