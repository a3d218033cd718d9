#include "io/place_strands.h"

#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace pelage::io {
namespace {

constexpr std::size_t kSamples = 1 << 16;  // points, or strands, that a guess looks at
constexpr std::size_t kGrain = 1 << 16;

// The units that exporters use, by the size of grooms that comes out between 6 cm and 5 m: a head of hair is
// 0.2 to 0.6 m, a coat is as long as its animal. Inches cannot be told from centimeters this way.
struct Unit {
  float below, scale;
  const char* name;
};
constexpr Unit kUnits[] = {{5, 1, "meters"}, {500, 0.01f, "centimeters"}, {INFINITY, 0.001f, "millimeters"}};

// Sides of the box that holds the middle 98 % of the coordinates on each axis: stray points do not count.
Vec3 typical_extent(const StrandSet& set) {
  const std::size_t step = std::max<std::size_t>(1, set.point_count() / kSamples);
  std::vector<float> axis[3];
  for (std::size_t i = 0; i < set.point_count(); i += step) {
    const Vec3 p = set.points[i];
    if (!is_finite(p)) continue;
    axis[0].push_back(p.x), axis[1].push_back(p.y), axis[2].push_back(p.z);
  }
  if (axis[0].empty()) return {};
  float side[3];
  for (int a = 0; a < 3; ++a) {
    std::vector<float>& values = axis[a];
    const std::size_t tail = values.size() / 100;
    const auto low = values.begin() + static_cast<std::ptrdiff_t>(tail);
    const auto high = values.end() - 1 - static_cast<std::ptrdiff_t>(tail);
    std::nth_element(values.begin(), low, values.end());
    const float lowest = *low;
    std::nth_element(values.begin(), high, values.end());
    side[a] = *high - lowest;
  }
  return {side[0], side[1], side[2]};
}

// Mean direction from root to tip, each strand weighing the same; its length is the agreement, 0…1.
Vec3 hanging_direction(const StrandSet& set) {
  const std::size_t step = std::max<std::size_t>(1, set.strand_count() / kSamples);
  Vec3 sum;
  std::size_t used = 0;
  for (std::size_t s = 0; s < set.strand_count(); s += step) {
    if (set.offsets[s + 1] - set.offsets[s] < 2) continue;
    const Vec3 along = set.points[set.offsets[s + 1] - 1] - set.points[set.offsets[s]];
    if (!is_finite(along) || !(dot(along, along) > 0)) continue;
    sum += normalize(along);
    ++used;
  }
  return used ? sum / static_cast<float>(used) : sum;
}

// Parts of the strands' mean direction from which gravity is believed in. Hair is often combed toward -Z, the back of a
// Y-up head, so that alone says little.
constexpr float kHangs = 0.25f, kLiesOnItsFace = 0.8f;

UpAxis guess_up(const FileStrands& file, ImportReport& report) {
  const Vec3 down = hanging_direction(file.strands);
  const bool y_hangs = -down.y > kHangs && -down.y > 2 * std::fabs(down.z);
  if (file.up_varies && y_hangs) {
    report.notes.emplace_back("taken as Y up because the strands hang along -Y; --up z overrides it");
    return UpAxis::kY;
  }
  if (file.up == UpAxis::kY && -down.z > kLiesOnItsFace)
    report.notes.emplace_back("the strands hang along -Z: if the groom lies on its face, give --up z");
  return file.up;
}

void choose_scale(const FileStrands& file, const ImportOptions& options, ImportReport& report) {
  if (options.scale > 0 || file.scale > 0) {
    report.scale = options.scale > 0 ? options.scale : file.scale;
    return;
  }
  const float size = length(typical_extent(file.strands));
  const Unit* unit = std::find_if(std::begin(kUnits), std::end(kUnits), [&](const Unit& u) { return size < u.below; });
  if (unit == std::end(kUnits)) --unit;
  report.scale = unit->scale;
  report.scale_guessed = true;
  report.notes.push_back(
      fmt::format("taken as {}: the groom is then {:.3g} m across; --scale overrides it", unit->name, size * unit->scale));
}

void choose_up(const FileStrands& file, const ImportOptions& options, ImportReport& report) {
  report.up_guessed = options.up == UpAxis::kAuto && !file.up_stated;
  report.up = options.up != UpAxis::kAuto ? options.up : file.up_stated ? file.up : guess_up(file, report);
}

// Human hair is 50 to 100 µm, vellus hair 10, a boar's bristle 300.
constexpr float kThinnest = 2e-6f, kThickest = 2e-3f;

float median_width(const std::vector<float>& widths) {
  const std::size_t step = std::max<std::size_t>(1, widths.size() / kSamples);
  std::vector<float> values;
  for (std::size_t i = 0; i < widths.size(); i += step)
    if (std::isfinite(widths[i])) values.push_back(widths[i]);
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Length of all strands together, file units; of a sample of them where there are many.
double total_length(const StrandSet& set) {
  const std::size_t step = std::max<std::size_t>(1, set.strand_count() / kSamples);
  double sum = 0;
  std::size_t used = 0;
  for (std::size_t s = 0; s < set.strand_count(); s += step, ++used)
    for (std::uint32_t i = set.offsets[s]; i + 1 < set.offsets[s + 1]; ++i) {
      const float piece = length(set.points[i + 1] - set.points[i]);
      if (std::isfinite(piece)) sum += piece;
    }
  return used ? sum * static_cast<double>(set.strand_count()) / static_cast<double>(used) : 0;
}

// A width for strands that come without. A full head of hair has a hundred thousand, an exchanged groom often a tenth, each
// standing for several: they get as thick as it takes to cover the faces of the groom's box once, within bounds.
constexpr float kHumanHair = 8e-5f, kThickestGuess = 10 * kHumanHair;

float guess_width(const StrandSet& set, float scale) {
  const Vec3 e = typical_extent(set) * scale;
  const double faces = 2.0 * (double{e.x} * e.y + double{e.y} * e.z + double{e.z} * e.x);
  const double covering = faces / std::max(total_length(set) * scale, 1e-9);
  return static_cast<float>(std::clamp(covering, double{kHumanHair}, double{kThickestGuess}));
}

void choose_widths(FileStrands& file, const ImportOptions& options, ImportReport& report) {
  std::vector<float>& widths = file.strands.widths;
  const float median = median_width(widths) * report.scale;
  const bool absurd = !(median >= kThinnest && median <= kThickest);
  if (widths.empty() || (file.width_is_fallback && absurd)) {
    report.width_guessed = !(options.default_width > 0);
    const float width = report.width_guessed ? guess_width(file.strands, report.scale) : options.default_width;
    if (report.width_guessed && !widths.empty() && widths[0] != 0)
      report.notes.push_back(
          fmt::format("the default thickness of the file, {} units, is no width of a hair; "
                      "{:.3g} mm assumed; --width overrides it",
                      widths[0], width * 1e3f));
    else if (report.width_guessed && width > kHumanHair)
      report.notes.push_back(
          fmt::format("no widths in the file: {:.3g} mm assumed, so that strands this few cover "
                      "(hair is 0.05 to 0.1 mm); --width overrides it",
                      width * 1e3f));
    widths.assign(1, width);
    return;
  }
  if (absurd)
    report.notes.push_back(
        fmt::format("the strands are {:.3g} mm wide (hair is 0.05 to 0.1 mm); is --scale right?", median * 1e3f));
  for (float& width : widths) width *= report.scale;
}

}  // namespace

void place_strands(FileStrands& file, const ImportOptions& options, ImportReport& report) {
  if (!(options.scale >= 0) || !std::isfinite(options.scale))
    throw Error("scale", fmt::format("{}", options.scale), "not a positive number", "give metres per file unit, e.g. 0.01");
  choose_scale(file, options, report);
  choose_up(file, options, report);
  choose_widths(file, options, report);

  const float k = report.scale;
  const bool turn = report.up == UpAxis::kZ;
  if (k == 1 && !turn) return;
  std::vector<Vec3>& points = file.strands.points;
  parallel_for(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 p = points[i];
      points[i] = (turn ? Vec3(p.x, p.z, -p.y) : p) * k;
    }
  });
}

}  // namespace pelage::io
