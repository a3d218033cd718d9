// compare_images(): every metric that was asked for, over the whole, the mask and the regions.
#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>

#include "core/nearest.h"
#include "metrics/field.h"
#include "metrics/pair.h"

namespace pelage {
namespace {

const Metric& metric_by_key(const std::string& key) {
  std::vector<std::string> keys;
  for (const Metric& metric : registered_metrics()) {
    if (metric.key == key) return metric;
    keys.push_back(metric.key);
  }
  throw Error("metric", key, "there is no such metric", fmt::format("did you mean `{}`?", nearest_name(key, keys)));
}

bool contains(const std::vector<std::string>& keys, const std::string& key) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

std::size_t count_pixels(const PixelSet& set) {
  if (set.mask.empty()) return static_cast<std::size_t>(set.rect.width) * static_cast<std::size_t>(set.rect.height);
  std::size_t count = 0;
  for (int y = set.rect.y; y < set.rect.y + set.rect.height; ++y)
    for (int x = set.rect.x; x < set.rect.x + set.rect.width; ++x) count += set.contains(x, y);
  return count;
}

class Comparer {
 public:
  Comparer(const Picture& test, const Picture& reference, const CompareOptions& options)
      : options_(options), pair_(test, reference, options), whole_{0, 0, pair_.width(), pair_.height()} {
    check_options();
    result_.domain = pair_.domain();
    result_.width = whole_.width, result_.height = whole_.height;
    result_.pixels = count_pixels(set(whole_));
    if (test.encoding != reference.encoding)
      result_.warnings.push_back(fmt::format("{} is display-encoded and {} scene-linear: compared as a display shows them",
                                             test.encoding == Encoding::kDisplay ? test.name : reference.name,
                                             test.encoding == Encoding::kDisplay ? reference.name : test.name));
    for (const Region& region : options.regions)
      result_.regions.push_back({region.name, region.rect, count_pixels(set(region.rect)), {}});
    for (const std::string& key : options.maps) result_.maps.push_back({key, {}});
  }

  Comparison run() {
    const std::vector<Metric> chosen = chosen_metrics();
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(chosen.size());
      if (options_.progress && !options_.progress("compare", share)) throw Error("compare", "", "cancelled", "");
      add(chosen[i]);
    }
    return std::move(result_);
  }

 private:
  void check_options() const {
    const std::size_t pixels = static_cast<std::size_t>(whole_.width) * static_cast<std::size_t>(whole_.height);
    if (!options_.mask.empty() && options_.mask.size() != pixels)
      throw Error("mask", "",
                  fmt::format("{} pixels; the pictures have {} × {}", options_.mask.size(), whole_.width, whole_.height),
                  "give a mask of the same size");
    for (const Region& region : options_.regions) {
      const PixelRect& r = region.rect;
      if (r.width < 1 || r.height < 1 || r.x < 0 || r.y < 0 || r.x > whole_.width - r.width || r.y > whole_.height - r.height)
        throw Error("region", region.name,
                    fmt::format("{} × {} pixels at ({}, {}) do not lie in {} × {}", r.width, r.height, r.x, r.y, whole_.width,
                                whole_.height),
                    "");
    }
    for (const std::string& key : options_.metrics) metric_by_key(key);
    for (const std::string& key : options_.maps)
      if (!metric_by_key(key).has_map) throw Error("map", key, "this metric has no error per pixel", "");
    if (!(options_.pixels_per_degree >= 1 && options_.pixels_per_degree <= 1000))
      throw Error("pixels per degree", "", fmt::format("{}", options_.pixels_per_degree), "1 to 1000");
  }

  // Those asked for, and those whose map is wanted, in the order of the registry.
  std::vector<Metric> chosen_metrics() const {
    std::vector<Metric> chosen;
    for (const Metric& metric : registered_metrics())
      if (options_.metrics.empty() || contains(options_.metrics, metric.key) || contains(options_.maps, metric.key))
        chosen.push_back(metric);
    return chosen;
  }

  void add(const Metric& metric) {
    const MetricInput input = pair_.input(metric.domain.value_or(pair_.domain()));
    if (const std::string why = metric.unavailable ? metric.unavailable(input) : ""; !why.empty()) {
      if (contains(options_.metrics, metric.key) || contains(options_.maps, metric.key))
        throw Error("metric", metric.key, why, "");
      result_.values.push_back({metric.key, std::nullopt, why});
      for (RegionValues& region : result_.regions) region.values.push_back({metric.key, std::nullopt, why});
      return;
    }
    MetricResult measured = metric.evaluate(input);
    result_.values.push_back(value_over(whole_, metric, measured));
    for (RegionValues& region : result_.regions) region.values.push_back(value_over(region.rect, metric, measured));
    for (MetricValue& detail : measured.details) result_.details.push_back(std::move(detail));
    for (ErrorMap& map : result_.maps)
      if (map.key == metric.key) map.error = measured.map;
  }

  MetricValue value_over(PixelRect rect, const Metric& metric, const MetricResult& measured) const {
    const PixelSet pixels = set(rect);
    const std::optional<double> value = measured.value ? measured.value(pixels) : metrics::mean_over(pixels, measured.map);
    if (value) return {metric.key, value};
    return {metric.key, value, count_pixels(pixels) ? metric.no_value : "no pixel counts here"};
  }

  PixelSet set(PixelRect rect) const { return {whole_.width, rect, options_.mask}; }

  const CompareOptions& options_;
  metrics::Pair pair_;
  PixelRect whole_;
  Comparison result_;
};

}  // namespace

std::optional<double> Comparison::value(const std::string& key) const {
  for (const MetricValue& v : values)
    if (v.key == key) return v.value;
  return std::nullopt;
}

Comparison compare_images(const Picture& test, const Picture& reference, const CompareOptions& options) {
  return Comparer(test, reference, options).run();
}

}  // namespace pelage
