// Where the head is at a time, as the simulation reads it.
#pragma once

#include <pelage/simulate.h>

#include "core/rotation.h"

namespace pelage::groom {

/// Throws Error where keys are out of order, not finite, or rotations not of unit length.
void check(const HeadMotion& motion);

/// The motion at `time`, as a key. Of sound motions.
HeadKey key_at(const HeadMotion& motion, double time);
/// From rest to where the head is then.
Rigid head_pose(const HeadMotion& motion, double time);

}  // namespace pelage::groom
