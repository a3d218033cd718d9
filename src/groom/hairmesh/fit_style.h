// Operators from what is left between strands and the base strands of their cage.
#pragma once

#include <vector>

#include <pelage/hair_mesh.h>

#include "groom/hairmesh/fit_bundle.h"

namespace pelage {

/// How the strands of a bundle, or of several, differ from their base on the average. Metres; shares 0…1.
struct StrandHabits {
  double strands = 0;
  double slow2 = 0, fast2 = 0;  ///< mean squares: of what varies over half of a strand or more, and of what is quicker
  double clump = 0, clumps = 1, clump_start = 0;
  double curl = 0;       ///< radius of a helix, or amplitude of waves
  double frequency = 0;  ///< turns along the cage
  double flatness = 0;   ///< 0 helix … 1 waves in a plane
  double curl_start = 0, curl_variation = 0;
  double frizz = 0, frizz_frequency = 0, frizz_variation = 0;
  double drift = 0, drift_variation = 0;  ///< slow part that clumps do not explain, root mean square
  double length_variation = 0;
  double tip_width = 1, tip_variation = 0, taper_start = 0;
};

StrandHabits measure_habits(const FitStrands& strands, const FitBundle& bundle);

/// Mean of habits, by their strands; that of curls by their squares.
StrandHabits mean_habits(const std::vector<StrandHabits>& habits);

/// Those operators that matter: which move a strand by more than a quarter of `width`, its diameter.
std::vector<StyleOperator> operators_of(const StrandHabits& habits, float width);

}  // namespace pelage
