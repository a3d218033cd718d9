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

/// Every length in metres. Defaults of `style` come from grow_defaults().
struct GrowSettings {
  HairStyle style = HairStyle::kStraight;
  std::uint64_t seed = 1;
  int strands = 50000;             ///< 1…1,000,000
  int points = 64;                 ///< per strand, 4…1024
  float length = 0.3f;             ///< of the longest strands
  float length_variation = 0.15f;  ///< standard deviation as a share of length, 0…1
  float width = 8e-5f;             ///< diameter at the root
  float width_variation = 0.15f;   ///< standard deviation as a share of width between strands
  float taper = 0.7f;              ///< share of the width that is gone at the tip, 0…1
  float curl_radius = 0;           ///< of the helix or wave
  float curl_pitch = 0.03f;        ///< length of one turn
  int clumps = 800;                ///< number of clumps on the scalp; 0 none
  float clump_tightness = 0.5f;    ///< 0 none … 1 tips meet
  float frizz = 0.3f;              ///< small-scale noise amplitude, 0…1
  float flyaways = 0.02f;          ///< share of strands that leave their clump, 0…1
  float gravity = 1;               ///< 0 stands, 1 hangs
};

/// Settings that make `style` look right.
GrowSettings grow_defaults(HairStyle style);

/// Names used on the command line and in scene files: "straight", "wavy", "curly", "afro", "ponytail", "coat".
const std::vector<std::string>& hair_style_names();
HairStyle hair_style_from_name(const std::string& name);  ///< throws Error naming the nearest style

/// Strands on `surface`: on its scalp where that is mannequin_head(), else on the whole of it.
/// Same settings and mesh: the same bits for any thread count. Throws Error on settings out of range or an empty mesh.
StrandSet grow(const GrowSettings& settings, const TriangleMesh& surface, const Progress& progress = {});

/// A head with face, ears and neck, about 0.24 m tall, facing +Z, standing on its neck around the origin; made by code.
TriangleMesh mannequin_head();

}  // namespace pelage
