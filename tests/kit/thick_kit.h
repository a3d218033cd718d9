// Thick hairs by hand.
#pragma once

#include <pelage/scene.h>

#include <memory>
#include <vector>

#include "kit/trace_kit.h"

namespace pelage::kit {

/// One cross-section, the same all along a hair. Metres.
struct Bundle {
  Vec3 major, minor;
  float fibers = 1, radius = 0;
  float spread = 0;  ///< radians²
  float twist = 0;   ///< radians a metre
};

/// Thick hairs of the given curves. turned: the minor axis lies in the plane of the curve, across it, whatever `minor` says but its length.
inline GroomInstance thick_hairs(const std::vector<std::vector<Vec3>>& curves, const Bundle& bundle, bool turned = false) {
  GroomInstance groom;
  groom.strands = strands(curves, 2 * length(bundle.major));
  auto sections = std::make_shared<ThickSections>();
  for (const std::vector<Vec3>& curve : curves)
    for (std::size_t i = 0; i < curve.size(); ++i) {
      const Vec3 along = curve[std::min(i + 1, curve.size() - 1)] - curve[i > 0 ? i - 1 : 0];
      sections->major.push_back(bundle.major);
      sections->minor.push_back(turned ? normalize(cross(bundle.major, along)) * length(bundle.minor) : bundle.minor);
      sections->fibers.push_back(bundle.fibers), sections->diameters.push_back(2 * bundle.radius);
      sections->spreads.push_back(bundle.spread), sections->twists.push_back(bundle.twist);
    }
  groom.sections = sections;
  return groom;
}
inline GroomInstance thick_hair(const std::vector<Vec3>& curve, const Bundle& bundle, bool turned = false) {
  return thick_hairs({curve}, bundle, turned);
}

}  // namespace pelage::kit
