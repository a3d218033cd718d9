// HDR-FLIP: FLIP of scene-linear pictures, the worst over the exposures at which a person might look at them
// (references.bib: Andersson2021Hdr).
#pragma once

#include <pelage/metrics.h>

namespace pelage::metrics {

struct Exposures {
  double start = 0, stop = 0;  ///< stops
  int count = 2;               ///< evenly between them, both included

  double at(int i) const { return start + i * (stop - start) / (count - 1); }
};

/// From the reference: at `start` its brightest pixel reaches 0.85 on the display, at `stop` its median pixel does; about one
/// stop apart, at least two.
Exposures find_exposures(const Image& reference);

/// The error of every pixel is the largest over the exposures. `details` of the result tells them.
MetricResult flip_hdr(const MetricInput& in);

}  // namespace pelage::metrics
