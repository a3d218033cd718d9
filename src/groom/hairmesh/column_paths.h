// The ways that the columns of a made hair mesh take from the scalp: falling, standing out all round, or tied.
#pragma once

#include <pelage/vec.h>

#include <vector>

#include "groom/hairmesh/scalp_grid.h"

namespace pelage::groom {

/// Hair that gravity takes from the parting down over head and shoulders.
struct Fall {
  float lift = 0.3f;          ///< share of the normal in the direction at the root
  float bend_length = 0.05f;  ///< metres over which gravity turns hair
  float volume = 0.016f;      ///< metres by which hair of the crown lies above that of the hairline
  float length = 0.3f;        ///< metres, longest
  float cut_front = -1;       ///< metres, y below which hair of the forehead is cut …
  float cut_back = -1;        ///< … and that of the nape
  float cling = 0.25f;        ///< 0…1: share of its height above where it belongs that hair of the crown loses a step
  float ragged = 0;           ///< metres by which the cut goes up and down
  float tuck = 0;             ///< 0…1: how far tips turn in below the chin
  float spread = 0;           ///< 0…1: how far hair stands away from the head as it falls
  float parting_x = 0;
};
/// Points about 3 mm apart, root first; all stay clear of the head.
std::vector<Vec3> fall_path(const ScalpColumn& column, const Fall& fall);

/// Hair that stands out to an ellipsoid around the head, `radius` metres wide at its widest.
std::vector<Vec3> ball_path(const ScalpColumn& column, float radius);

/// Hair that is combed close over the head to a tie at the back, and hangs from it as a tail.
struct Tie {
  float lift = 0.004f;    ///< metres above the skin at most
  float length = 0.3f;    ///< metres of the tail
  float radius = 0.024f;  ///< metres, of the tail at its widest
  float waist = 0.009f;   ///< metres, at the tie
  float tip = 0.25f;      ///< the end's width as a share of the widest
};
struct TiedPath {
  std::vector<Vec3> to_tie, tail;  ///< the tail begins where the other ends
};
/// `place`: in the unit disk across the tail, x to the left and y up where it leaves the head.
TiedPath tied_path(const ScalpColumn& column, const Tie& tie, Vec2 place);
/// Where a root belongs across the tail so that nothing crosses: by its direction and distance from the tie.
Vec2 tail_place(Vec3 root);

/// `layers` points of a path at shares of its length that lie closer at the root, where it bends; share 0…0.6 of that.
std::vector<Vec3> resample(const std::vector<Vec3>& path, int layers, float denser_at_root);

}  // namespace pelage::groom
