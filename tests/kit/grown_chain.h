// Grown hair with its chain of thick hairs, and an eye that looks at it.
#pragma once

#include <pelage/grow.h>
#include <pelage/lod.h>
#include <pelage/scene.h>

#include <memory>

#include "frame/camera_view.h"

namespace pelage::kit {

inline GroomInstance groom_with_chain(HairStyle style, int strands, std::uint32_t levels) {
  GrowSettings s = grow_defaults(style);
  s.strands = strands, s.points = 24;
  GroomInstance groom;
  auto set = std::make_shared<const StrandSet>(grow(s, mannequin_head()));
  groom.lod = std::make_shared<const LodHierarchy>(build_lod(*set, {.levels = levels, .guides = 24, .memory_share = 5}));
  groom.strands = set;
  return groom;
}

inline CameraView view_from(Vec3 eye) {
  Camera camera;
  camera.eye = eye;
  return make_camera_view(camera, 320, 240);
}

}  // namespace pelage::kit
