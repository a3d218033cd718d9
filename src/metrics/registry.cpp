// The list of metrics.
#include <pelage/error.h>

#include <algorithm>

#include "metrics/builtin.h"

namespace pelage {
namespace {

std::vector<Metric>& registry() {
  static std::vector<Metric> list{metrics::mse_metric(),      metrics::relative_mse_metric(),  metrics::psnr_metric(),
                                  metrics::ssim_metric(),     metrics::ms_ssim_metric(),       metrics::flip_metric(),
                                  metrics::coverage_metric(), metrics::coverage_bias_metric(), metrics::energy_metric()};
  return list;
}

}  // namespace

const std::vector<Metric>& registered_metrics() { return registry(); }

void register_metric(Metric metric) {
  if (metric.key.empty() || !metric.evaluate)
    throw Error("register_metric()", metric.key, "a metric needs a key and a function", "");
  std::vector<Metric>& list = registry();
  const auto same = std::find_if(list.begin(), list.end(), [&](const Metric& m) { return m.key == metric.key; });
  if (same != list.end()) *same = std::move(metric);
  else list.push_back(std::move(metric));
}

}  // namespace pelage
