// How near a fitted hair mesh comes to its groom.
#pragma once

#include <pelage/hair_mesh_fit.h>

#include <vector>

#include "groom/hairmesh/fit_bundle.h"

namespace pelage {

/// Fills all of `report` but slow_rms and fast_rms.
void measure_fit(const FitStrands& strands, const std::vector<FitBundle>& bundles, const HairMesh& mesh,
                 HairMeshFitReport& report);

}  // namespace pelage
