#include "report/measure.h"

#include <fmt/format.h>
#include <pelage/error.h>
#include <pelage/io.h>
#include <pelage/metrics.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace pelage::report {
namespace {

constexpr const char* kErrorMetric = "flip";  // of the error maps

bool has_coverage(const Picture& picture) {
  const auto& names = picture.image.channels;
  return std::find(names.begin(), names.end(), "coverage") != names.end();
}

// One case with what is known of its files; errors of the library are told with the case and the picture.
class CaseReader {
 public:
  CaseReader(const Cases& cases, const Case& c) : cases_(cases), case_(c) {}

  template <class Work>
  auto told(const std::string& what, Work work) const {
    try {
      return work();
    } catch (const Error& e) {
      throw Error(cases_.path, fmt::format("case \"{}\": {}", case_.title, what), e.what(), "");
    }
  }

  Picture read(const std::string& file, const std::string& what) const {
    return told(what, [&] { return read_picture(cases_.file(file)); });
  }

  // As it stands in the file, but for the exposure.
  Picture read(const Entry& entry) const {
    Picture picture = read(entry.file, entry.method);
    if (picture.encoding == Encoding::kLinear && cases_.exposure != 0)
      for (std::size_t i = 0; i < picture.image.pixels.size(); ++i)
        if (is_color(picture.image.channels[i % picture.image.channel_count()]))
          picture.image.pixels[i] *= std::exp2(cases_.exposure);
    return picture;
  }

  // Scene-linear R, G, B; a single channel counts for all three.
  Image linear_colors(const Picture& picture, const Entry& entry) const {
    const Image image = picture.encoding == Encoding::kLinear ? picture.image : read_image(cases_.file(entry.file));
    const auto channel = [&](const std::string& name) {
      const auto found = std::find(image.channels.begin(), image.channels.end(), name);
      return found == image.channels.end() ? 0 : found - image.channels.begin();
    };
    const std::ptrdiff_t from[3] = {channel("R"), channel("G"), channel("B")};
    Image colors(image.width, image.height, {"R", "G", "B"});
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < 3; ++c) colors.at(x, y)[c] = image.at(x, y)[from[c]];
    return colors;
  }

  // Empty where nothing tells which pixels are hair.
  PixelMask hair(const Picture& reference) const {
    if (!case_.mask.empty()) {
      const Picture mask = read(case_.mask, "mask");
      return told("mask", [&] { return mask_from_image(mask); });
    }
    if (!has_coverage(reference)) return {};
    return told(case_.reference, [&] { return hair_mask(reference); });
  }

 private:
  static bool is_color(const std::string& channel) {
    return channel == "R" || channel == "G" || channel == "B" || channel == "Y";
  }

  const Cases& cases_;
  const Case& case_;
};

// In the order of columns(). What has no value because two pictures are equal is infinite.
Numbers in_columns(const Cases& cases, const Comparison& comparison, const Entry& entry) {
  Numbers numbers;
  const bool equal = comparison.value("mse") == 0;
  for (const Column& column : columns(cases)) {
    const auto extra =
        std::find_if(entry.values.begin(), entry.values.end(), [&](const auto& v) { return v.first == column.key; });
    std::optional<double> value = extra == entry.values.end() ? comparison.value(column.key) : extra->second;
    if (!value && equal && column.key == "psnr") value = std::numeric_limits<double>::infinity();
    numbers.push_back(value);
  }
  return numbers;
}

std::string label(const std::string& key) {
  static const std::map<std::string, std::string> known{{"flip", "FLIP"},
                                                        {"psnr", "PSNR"},
                                                        {"ssim", "SSIM"},
                                                        {"ms_ssim", "MS-SSIM"},
                                                        {"mse", "MSE"},
                                                        {"relative_mse", "relMSE"},
                                                        {"coverage_error", "Coverage"},
                                                        {"coverage_bias", "Coverage bias"}};
  const auto found = known.find(key);
  return found == known.end() ? key : found->second;
}

// Bias is a signed number: nearer to 0 is better, which a column cannot say.
bool is_shown(const Metric& metric) { return metric.key != "coverage_bias" && metric.key != "energy"; }

// Alpha, which the library takes where the channel is missing, is 1 all over pictures that have a background.
Comparison without_alpha_error(Comparison comparison, const Picture& picture, const Picture& reference) {
  if (!has_coverage(picture) || !has_coverage(reference))
    std::erase_if(comparison.values, [](const MetricValue& v) { return v.key == "coverage_error"; });
  return comparison;
}

}  // namespace

std::vector<Column> columns(const Cases& cases) {
  std::vector<Column> table;
  for (const Metric& metric : registered_metrics())
    if (is_shown(metric)) table.push_back({metric.key, label(metric.key), metric.description, metric.higher_is_better});
  std::stable_partition(table.begin(), table.end(), [](const Column& column) { return column.key == kErrorMetric; });
  for (const ExtraMetric& value : cases.values)
    table.push_back({value.name, value.name, value.about, value.better == ExtraMetric::Better::kHigher});
  return table;
}

MeasuredCase measure(const Cases& cases, const Case& c) {
  const CaseReader reader(cases, c);
  const auto is_reference = [&](const Entry& e) { return e.method == c.reference; };
  const Entry& reference_entry = *std::find_if(c.images.begin(), c.images.end(), is_reference);
  const Picture reference = reader.read(reference_entry);

  MeasuredCase result;
  result.numbers.width = reference.image.width;
  result.numbers.height = reference.image.height;
  result.tone_map = cases.tone_map.value_or(reference.encoding == Encoding::kLinear ? ToneMap::kAces : ToneMap::kNone);
  // As a display shows them: the numbers are those of the pictures that the page shows.
  CompareOptions whole, hair;
  whole.tone_map = hair.tone_map = result.tone_map;
  whole.maps = {kErrorMetric};
  hair.mask = reader.hair(reference);
  result.numbers.hair_pixels =
      static_cast<std::uint64_t>(std::count_if(hair.mask.begin(), hair.mask.end(), [](auto m) { return m != 0; }));

  for (const Entry& entry : c.images) {
    Measurement& m = result.numbers.entries.emplace_back();
    Image& error = result.errors.emplace_back();
    const Picture picture = is_reference(entry) ? reference : reader.read(entry);
    reader.told(entry.method, [&] {
      Comparison comparison =
          without_alpha_error(compare_images(picture, reference, whole), picture, reference);  // of the reference: checks it
      if (is_reference(entry)) return;
      m.whole = in_columns(cases, comparison, entry);
      error = std::move(comparison.maps.front().error);
      if (result.numbers.hair_pixels > 0)
        m.hair = in_columns(cases, without_alpha_error(compare_images(picture, reference, hair), picture, reference), entry);
    });
    result.pictures.push_back(reader.linear_colors(picture, entry));
  }
  return result;
}

}  // namespace pelage::report
