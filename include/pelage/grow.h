// Hair made from a seed: demo, benchmark and training data.
#pragma once

#include <pelage/progress.h>
#include <pelage/strand_set.h>
#include <pelage/triangle_mesh.h>

#include <cstdint>
#include <string>
#include <vector>

namespace pelage {

enum class HairStyle { kStraight, kWavy, kCurly, kAfro, kPonytail, kCoat };

/// What to grow. Lengths are metres, shares are 0…1; grow() throws an Error that names the setting and its range when one is
/// outside it. Settings that suit a style come from grow_defaults().
struct GrowSettings {
  HairStyle style = HairStyle::kStraight;
  std::uint64_t seed = 1;          ///< any; another seed is another head of hair
  int strands = 50000;             ///< 1…1,000,000
  int points = 64;                 ///< per strand, 4…1024; curls want eight and more a turn
  float length = 0.3f;             ///< mean arc length of a strand, metres, 0.0001…10
  float length_variation = 0.15f;  ///< standard deviation as a share of length, 0…0.5
  float width = 8e-5f;             ///< mean diameter at the root, metres, 0…0.1
  float width_variation = 0.15f;   ///< standard deviation as a share of width between strands, 0…0.5
  float taper = 0.7f;              ///< share of the width that is gone at the tip, 0…1
  float curl_radius = 0;           ///< mean radius of the helix (curly, afro) or amplitude of the wave, metres, 0…1; 0 none
  float curl_pitch = 0.03f;        ///< mean distance along a lock in which it turns once, metres, 0.0001…10
  int clumps = 800;  ///< number of locks, each with a guide, 0…1,000,000; 0 none (a few guides still shape the whole)
  float clump_tightness = 0.5f;  ///< 0 none … 1 tips meet
  float frizz = 0.3f;            ///< small-scale noise, 0 combed … 1 unruly
  float flyaways = 0.02f;        ///< share of strands that leave their lock, 0…1
  float gravity = 1;             ///< 0 stands, 1 hangs
  float volume = 0.014f;         ///< distance from the skin to which hair of the crown piles up, metres, 0…0.5
  float parting = 0.018f;        ///< where the parting runs on the mannequin, metres left of the middle, −0.05…0.05
  float undercoat = 0.65f;       ///< coat: share of short, fine, wavy wool between the guard hairs, 0…1
};

/// Values of StrandSet::group that grow() gives.
enum class HairGroup : std::uint16_t {
  kScalp = 0,    ///< ordinary hair; of a coat the guard hairs
  kFlyaway = 1,  ///< strays outside their lock
  kTail = 2,     ///< gathered in the ponytail
  kWool = 3,     ///< undercoat
};

/// Settings that make `style` look right.
GrowSettings grow_defaults(HairStyle style);

/// Names used on the command line and in scene files: "straight", "wavy", "curly", "afro", "ponytail", "coat".
const std::vector<std::string>& hair_style_names();
HairStyle hair_style_from_name(const std::string& name);  ///< throws Error naming the nearest style

/// Strands on `surface`: on its scalp where that is mannequin_head(), else on the whole of it. The mesh may be open or not
/// manifold; triangles without area carry no hair. A ponytail is tied on the mannequin only; elsewhere it hangs as straight.
///
/// Every strand has `points` points, a root uv, a guide and a group (HairGroup). Strands are ordered by guide; strand_id
/// numbers them so that those below any n are an even thinning of the whole.
/// Same settings and mesh: the same bits for any thread count. 16 bytes a control point are held at the end, under 20 on the way.
/// Throws Error on settings out of range, on a mesh without area, with indices out of range or coordinates not finite.
StrandSet grow(const GrowSettings& settings, const TriangleMesh& surface, const Progress& progress = {});

/// A head with face, ears, neck and shoulders, facing +Z: 0.24 m from chin to crown, eyes at the height of the origin, closed,
/// with smooth normals and a texture coordinate without seam on the scalp. Made by code; the same bits at every call.
TriangleMesh mannequin_head();

/// Whether `strands` stand on the scalp of mannequin_head(), as grow() leaves them there: then that head belongs below them.
/// Told by the places of the roots, so that every file format keeps it and a groom that was moved or scaled lost it.
bool grown_on_mannequin(const StrandSet& strands);

}  // namespace pelage
