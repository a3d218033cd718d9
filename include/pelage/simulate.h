// Guides as elastic rods on a moving head: what `pelage simulate` runs. docs/simulation.md has the equations.
#pragma once

#include <pelage/animation.h>
#include <pelage/lod.h>
#include <pelage/progress.h>
#include <pelage/triangle_mesh.h>
#include <pelage/vec.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pelage {

/// Where the head is at one time.
struct HeadKey {
  double time = 0;            ///< seconds, increasing from key to key
  Vec3 translation;           ///< metres
  Vec4 rotation{0, 0, 0, 1};  ///< unit quaternion (x, y, z, w), about HeadMotion::pivot
};

/// How the head moves: cubic Hermite curves through the keys, at rest at both ends and outside of them. No keys: it stays.
struct HeadMotion {
  Vec3 pivot;  ///< metres, in the space of the groom at rest
  std::vector<HeadKey> keys;
};

/// From rest to where the head is at `time`, seconds: a rotation and a translation.
Affine head_at(const HeadMotion& motion, double time);

/// Names of motions that need no file: "still", "nod", "turn", "walk" (on the spot).
const std::vector<std::string>& head_motion_names();
/// One of them for `seconds` seconds. Throws Error naming the nearest name.
HeadMotion head_motion(const std::string& name, double seconds, Vec3 pivot);
/// Where a head with these guides turns: below the middle of their roots.
Vec3 neck_of(const LodHierarchy& lod);

/// Reads keyframes from a JSON file (docs/simulation.md). `pivot` is what the file can say otherwise. Throws Error naming line and key.
HeadMotion read_head_motion(const std::string& path, Vec3 pivot);

/// What moves the hair, and how it resists. Metres, seconds. simulate() throws an Error that names the setting and its range when one is
/// outside it. All that is elastic is per mass of the strand, so no mass is given.
struct SimulationSettings {
  std::uint32_t frames = 240;    ///< 1…100000
  std::int32_t first_frame = 1;  ///< number of the first, −10⁶…10⁶; it is at time 0
  float frame_rate = 24;         ///< frames a second, 1…1000
  float longest_step = 1e-3f;    ///< seconds of a substep, at most, 1e-5…0.02
  float preroll = 0;             ///< seconds before the first frame in which the head holds still and wind blows, 0…60

  Vec3 gravity{0, -9.81f, 0};  ///< m/s², at most 1000 long
  float support = 1;           ///< share of their weight at rest that strands do not feel, so that they keep their style, 0…1
  float bend_stiffness = 1e-3f;    ///< EI over mass per length, m⁴/s², 0…1; a human hair's is about 1e-3
  float stretch_stiffness = 3e6f;  ///< EA over mass per length, m²/s², 1…1e9; a human hair's is about 3e6
  float most_stretch = 0.05f;      ///< share of its length by which no piece of a strand is ever longer, 0.001…1
  float shape_frequency =
      4;              ///< Hz, at the root: how fast strands swing back to where they are on the head at rest, 0…100; falls
                      ///< with the square of the share of length that is left, to none at the tip
  float damping = 2;  ///< 1/s, of motion against the head's, 0…1000
  float drag = 2;     ///< 1/s, of motion against the air's, 0…1000

  Vec3 wind;               ///< m/s: direction and speed, at most 1000
  float gusts = 0.5f;      ///< by what share of its speed wind varies, 0…10
  float gust_size = 0.3f;  ///< metres from one gust to the next, 0.01…100
  std::uint32_t seed = 1;  ///< of the gusts

  float clearance = 0.002f;  ///< metres that guides keep from the head, 0…0.1; less where they are nearer at rest
  float friction = 0.3f;     ///< of hair on the head, 0…1
};

/// What hair collides with, made ready: signed distances to a head.
class HeadShape;
/// Distances to `mesh` on a grid of about `cells` cells along its longest side, 8…512. A mesh that is open counts as the surface that it is;
/// triangles wind counter-clockwise from outside. Throws Error on a mesh without triangles or with indices out of range, and when cancelled.
std::shared_ptr<const HeadShape> make_head_shape(const TriangleMesh& mesh, int cells = 64, const Progress& progress = {});

/// Moves the guides of `lod` on a head that moves by `motion` and, where it is not null, has the shape `head`, as the groom has it at
/// rest: extended position-based dynamics of rods (Müller 2007, Macklin 2016; references.bib: Muller2007Position, Macklin2016XPBD).
/// The first two control points of a guide go with the head.
///
/// The same bits for any thread count. Throws Error where `lod` is empty or a setting is out of range, and when cancelled. Rods do not
/// meet each other. O(frames · substeps · control points).
GuideAnimation simulate(const LodHierarchy& lod, const SimulationSettings& settings, const HeadMotion& motion = {},
                        const std::shared_ptr<const HeadShape>& head = nullptr, const Progress& progress = {});

}  // namespace pelage
