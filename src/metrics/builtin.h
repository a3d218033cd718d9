// The metrics that Pelage brings along, one function each, in the order of the registry.
#pragma once

#include <pelage/metrics.h>

namespace pelage::metrics {

Metric mse_metric();
Metric relative_mse_metric();
Metric psnr_metric();
Metric ssim_metric();
Metric ms_ssim_metric();
Metric flip_metric();
Metric coverage_metric();
Metric coverage_bias_metric();
Metric energy_metric();

}  // namespace pelage::metrics
