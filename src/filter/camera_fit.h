// The camera of a picture, from where it shows places: least squares instead of every renderer's own convention.
#pragma once

#include <pelage/vec.h>

#include <span>

namespace pelage {

/// A map from a space of three dimensions to the screen that keeps lines straight: x = row₀·(X,1) / row₂·(X,1), likewise y.
///
/// Perspective and orthographic cameras are such maps of world space, of their own space, and of any object's. The default
/// takes x and y as they are.
class ProjectiveCamera {
 public:
  /// What is at `position`, seen: pixels, and how far away (in units of the camera's own; 1 throughout where it is orthographic).
  struct Seen {
    Vec2 screen;
    float distance = 1;
  };
  /// False behind the camera.
  bool see(Vec3 position, Seen& seen) const;
  /// Where something at `position` that moves along `direction` moves on the screen: pixels per length of `direction`.
  Vec2 move(Vec3 position, Vec3 direction) const;
  /// Pixels per unit of length, facing the camera: root of the mean over all directions, which the screen's two take part in.
  float pixels_per_unit(Vec3 position) const;

 private:
  friend ProjectiveCamera fit_camera(std::span<const Vec3> positions, std::span<const Vec2> screen);
  double rows_[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}};
};

/// The camera that shows positions[i] at screen[i], pixels, with the least sum of squares; a pixel of noise in each of n
/// places moves what it shows by about a pixel over √n. Directions in which the positions do not extend (a flat sheet, a single
/// place) do not move on the screen. Deterministic; O(places).
ProjectiveCamera fit_camera(std::span<const Vec3> positions, std::span<const Vec2> screen);

}  // namespace pelage
