// Knitted cloth made from a seed, fiber by fiber: the other thing than hair that bundles of fibers make up.
#pragma once

#include <pelage/progress.h>
#include <pelage/strand_set.h>

#include <cstdint>
#include <string>
#include <vector>

namespace pelage {

enum class KnitPattern {
  kStockinette,  ///< every stitch a knit stitch: columns of V's
  kRib,          ///< two columns of knit stitches, two of purl stitches, which lie behind
};

/// A patch of cloth, its yarns, their plies and their fibers. Metres; grow_knit() throws an Error that names the setting and its
/// range when one is outside it.
struct KnitSettings {
  KnitPattern pattern = KnitPattern::kStockinette;
  std::uint64_t seed = 1;      ///< any; another seed is another patch
  int strands = 60000;         ///< as near as every ply can have equally many fibers, 1…1,000,000
  int points = 24;             ///< per strand, 4…1024; twists want twelve and more a turn
  int wales = 14;              ///< columns of stitches, 1…1000
  int courses = 16;            ///< rows of stitches, each a yarn, 1…1000
  float yarn = 0.0015f;        ///< diameter, 0.0001…0.1; a stitch is 3.3 of them wide and 2.5 high
  int plies = 3;               ///< of a yarn, 1…16
  float ply_pitch = 5;         ///< diameters of a yarn along which its plies turn once about each other, 1…1000
  float fiber_pitch = 4.2f;    ///< and the fibers of a ply, in space and the other way round, as spun yarns have it, 1…1000
  float packing = 0.45f;       ///< share of a ply's section that fibers take, 0.01…1: how thick they are
  float migration = 0.3f;      ///< share of their distance from the ply's middle that fibers give up on their way, 0…1
  float irregularity = 0.12f;  ///< amplitude of the cloth's unevenness, diameters of a yarn, 0…0.5
};

/// Names used on the command line: "knit-stockinette", "knit-rib".
const std::vector<std::string>& knit_pattern_names();
KnitPattern knit_pattern_from_name(const std::string& name);  ///< throws Error naming the nearest pattern

/// Fibers of a patch around the origin that faces +Z, courses from −Y to +Y. Each strand is a fiber along half a stitch, from the top of a
/// loop to the bottom or back, and goes on in the next one. Strands stand course by course, along the yarn, ply by ply: those of one piece of a
/// ply follow one another, and their guide_id is the first of them. strand_id numbers them so that those below any n are
/// an even thinning of the whole; root_uv is the place on the patch, 0…1 each.
///
/// Same settings: the same bits for any thread count. Throws Error on settings out of range and when cancelled.
StrandSet grow_knit(const KnitSettings& settings, const Progress& progress = {});

}  // namespace pelage
