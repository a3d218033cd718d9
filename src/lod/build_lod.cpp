// Strands → stations → guides → clusters → ellipses: the chain of thick hairs.
#include <pelage/error.h>
#include <pelage/lod.h>

#include <fmt/format.h>

#include <algorithm>

#include "core/parallel.h"
#include "core/shared_progress.h"
#include "frame/strand_path.h"
#include "lod/clusters.h"
#include "lod/cross_section.h"
#include "lod/guide_hairs.h"
#include "lod/stations.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;

template <class T>
void check_range(const char* name, T value, T low, T high) {
  if (!(value >= low && value <= high))
    throw Error("lod", name, fmt::format("{} is outside {} … {}", value, low, high), "choose a value in that range");
}

void check(const StrandSet& strands, const LodSettings& s) {
  check_range("levels", s.levels, 1u, LodHierarchy::kMostLevels);
  check_range("guides", s.guides, 0u, 65536u);
  check_range("area_ratio", s.area_ratio, 1.5f, 64.f);
  check_range("covered", s.covered, 0.5f, 1.f);
  check_range("memory_share", s.memory_share, 0.01f, 100.f);
  validate(strands, "lod");
  if (strands.strand_count() == 0) throw Error("lod", "", "the groom has no strands", "give one that has");
}

/// Strand indices of the guides that `settings` ask for.
std::vector<std::uint32_t> guides_of(const StrandSet& strands, const Stations& stations, const LodSettings& settings,
                                     const Progress& progress) {
  if (settings.guides > 0) return choose_guides(stations, settings.guides, settings.seed, progress);
  std::vector<std::uint32_t> guides = own_guides(strands);
  if (guides.empty())
    throw Error("lod", "guides", "the strands of this groom name no guides among them", "give a number of guides");
  return guides;
}

void set_guides(const Stations& stations, const std::vector<std::uint32_t>& strands, LodHierarchy& lod) {
  lod.guide_strands = strands;
  lod.guides.resize(strands.size() * kPoints);
  for (std::size_t g = 0; g < strands.size(); ++g) bspline_through(stations.strand(strands[g]), &lod.guides[g * kPoints]);
}

void set_strand_weights(const Stations& stations, LodHierarchy& lod) {
  lod.strand_weights.resize(stations.strand_count());
  const auto guide = [&](std::uint32_t g) { return stations.strand(lod.guide_strands[g]); };
  parallel_for(lod.prisms.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const ThickHair& hair = lod.hairs[p];
      const Prism& prism = lod.prisms[p];
      for (std::uint32_t i = hair.first_strand; i < hair.first_strand + hair.fibers; ++i)
        lod.strand_weights[lod.order[i]] =
            prism_weights(stations.strand(lod.order[i]), guide(prism[0]), guide(prism[1]), guide(prism[2]));
    }
  });
}

/// What a hair takes, its colors and texture coordinate included where the groom has them.
std::size_t bytes_of_hair(const StrandSet& set) {
  return sizeof(ThickHair) + sizeof(Vec2) + 2 * sizeof(float) +
         kPoints * (3 * sizeof(Vec3) + 2 * sizeof(Vec2) + sizeof(float)) + (set.colors.empty() ? 0 : sizeof(Vec3)) +
         (set.root_uv.empty() ? 0 : sizeof(Vec2));
}

/// Levels until there are as many as asked for, nothing is left to divide, or the next one would take too much memory.
void add_levels(const StrandSet& set, const Stations& stations, const LodSettings& settings, const Progress& progress,
                LodHierarchy& lod) {
  const auto allowed = static_cast<double>(settings.memory_share) *
                       static_cast<double>(set.point_count() * sizeof(Vec3) + set.widths.size() * sizeof(float));
  const std::size_t beside =
      resident_bytes(lod) - lod.hair_count() * sizeof(ThickHair) - lod.level_offsets.size() * sizeof(std::uint32_t);
  SharedProgress shared(progress, "lod levels", settings.levels);
  shared.add(1);
  while (lod.levels() < settings.levels) {
    const std::size_t before = lod.hair_count();
    LodHierarchy finer = lod;
    divide_finest_level(stations, settings, finer);
    if (finer.hair_count() - before == before - lod.level_offsets[lod.levels() - 1]) break;
    const std::size_t bytes = beside + sizeof(std::uint32_t) * (finer.levels() + 1) + finer.hair_count() * bytes_of_hair(set);
    if (static_cast<double>(bytes) > allowed) break;
    lod = std::move(finer);
    shared.add(1);
  }
  shared.add(settings.levels - lod.levels());
}

/// Length of a center's curve, not of its control polygon, which is longer.
double spline_length(const Vec3* control) {
  thread_local StrandPath path;
  thread_local StrandSet center;
  center.basis = CurveBasis::kBSpline, center.offsets = {0, kPoints}, center.widths = {0};
  center.points.assign(control, control + kPoints);
  path.assign(center, 0);
  return path.length();
}

/// The curves of a hair, and how its weights grow toward its corners.
class HairWriter {
 public:
  HairWriter(const StrandSet& set, const Stations& stations, const LodSettings& settings, LodHierarchy& lod)
      : set_(set), stations_(stations), settings_(settings), lod_(lod) {
    const std::size_t n = lod.hair_count();
    lod.weights.resize(n), lod.length_ratios.resize(n), lod.twists.resize(n);
    lod.centers.resize(n * kPoints), lod.major.resize(n * kPoints), lod.minor.resize(n * kPoints);
    lod.major_weights.resize(n * kPoints), lod.minor_weights.resize(n * kPoints), lod.radii.resize(n * kPoints);
    lod.colors.resize(set.colors.empty() ? 0 : n), lod.root_uv.resize(set.root_uv.empty() ? 0 : n);
  }

  void write(std::size_t h) {
    const ThickHair& hair = lod_.hairs[h];
    const std::span<const std::uint32_t> strands(&lod_.order[hair.first_strand], hair.fibers);
    auto sections = fit_cross_sections(stations_, strands, settings_.covered, true);
    lod_.twists[h] = twist_of(stations_, strands, sections);
    keep_widths(sections);
    std::array<Vec3, kPoints> centers;
    lod_.weights[h] = mean_of(strands, [&](std::uint32_t s) { return lod_.strand_weights[s]; });
    for (std::size_t k = 0; k < kPoints; ++k) {
      const CrossSection& section = sections[k];
      const std::size_t i = h * kPoints + k;
      centers[k] = section.center;
      lod_.major[i] = section.major, lod_.minor[i] = section.minor, lod_.radii[i] = section.radius;
      lod_.major_weights[i] = growth(strands, k, section, section.major, lod_.weights[h]);
      lod_.minor_weights[i] = growth(strands, k, section, section.minor, lod_.weights[h]);
    }
    bspline_through(centers.data(), &lod_.centers[h * kPoints]);
    lod_.length_ratios[h] = length_ratio(strands, &lod_.centers[h * kPoints]);
    if (!lod_.root_uv.empty()) lod_.root_uv[h] = mean_of(strands, [&](std::uint32_t s) { return set_.root_uv[s]; });
    if (!lod_.colors.empty()) lod_.colors[h] = mean_color(strands);
  }

 private:
  using Sections = std::array<CrossSection, kPoints>;

  /// Axes are control values of B-splines, which smooth: what that would take away at the knots is added beforehand.
  static void keep_widths(Sections& sections) {
    constexpr float kMost = 1.5f;
    const Sections fitted = sections;
    for (std::size_t k = 1; k + 1 < kPoints; ++k)
      for (Vec3 CrossSection::*axis : {&CrossSection::major, &CrossSection::minor}) {
        const Vec3 smooth = (fitted[k - 1].*axis + fitted[k].*axis * 4.f + fitted[k + 1].*axis) / 6.f;
        const float whole = length(fitted[k].*axis), left = length(smooth);
        sections[k].*axis *= left > 0 ? std::clamp(whole / left, 1.f, kMost) : kMost;
      }
    put_longer_first(sections);
  }

  template <class Value>
  static Vec2 mean_of(std::span<const std::uint32_t> strands, const Value& value) {
    double x = 0, y = 0;
    for (const std::uint32_t s : strands) x += static_cast<double>(value(s).x), y += static_cast<double>(value(s).y);
    const auto n = static_cast<double>(strands.size());
    return {static_cast<float>(x / n), static_cast<float>(y / n)};
  }

  /// Regression of the strands' weights over their places along `axis`, at the axis' end. A fiber's radius counts as spread:
  /// where fibers lie closer together than they are thick, their order tells nothing.
  Vec2 growth(std::span<const std::uint32_t> strands, std::size_t k, const CrossSection& section, Vec3 axis, Vec2 mean) const {
    const auto r2 = static_cast<double>(section.radius) * static_cast<double>(section.radius);
    double xx = static_cast<double>(strands.size()) * r2 * static_cast<double>(dot(axis, axis)), first = 0, second = 0;
    for (const std::uint32_t s : strands) {
      const auto x = static_cast<double>(dot(stations_.strand(s)[k] - section.center, axis));
      const Vec2 off = lod_.strand_weights[s] - mean;
      xx += x * x, first += x * static_cast<double>(off.x), second += x * static_cast<double>(off.y);
    }
    if (!(xx > 0)) return {};
    const double scale = static_cast<double>(dot(axis, axis)) / xx;
    return {static_cast<float>(first * scale), static_cast<float>(second * scale)};
  }

  float length_ratio(std::span<const std::uint32_t> strands, const Vec3* center) const {
    double fibers = 0;
    for (const std::uint32_t s : strands) fibers += static_cast<double>(stations_.lengths[s]);
    const double line = spline_length(center);
    return line > 0 && fibers > 0 ? static_cast<float>(fibers / (line * static_cast<double>(strands.size()))) : 1;
  }

  Vec3 mean_color(std::span<const std::uint32_t> strands) const {
    const bool per_point = set_.colors.size() != set_.strand_count();
    double r = 0, g = 0, b = 0;
    for (const std::uint32_t s : strands) {
      const std::size_t first = per_point ? set_.offsets[s] : s, end = per_point ? set_.offsets[s + 1] : s + 1;
      const double share = 1 / (static_cast<double>(end - first) * static_cast<double>(strands.size()));
      for (std::size_t i = first; i < end; ++i)
        r += share * static_cast<double>(set_.colors[i].x), g += share * static_cast<double>(set_.colors[i].y),
            b += share * static_cast<double>(set_.colors[i].z);
    }
    return {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b)};
  }

  const StrandSet& set_;
  const Stations& stations_;
  const LodSettings& settings_;
  LodHierarchy& lod_;
};

}  // namespace

LodHierarchy build_lod(const StrandSet& strands, const LodSettings& settings, const Progress& progress) {
  check(strands, settings);
  LodHierarchy lod;
  const Stations stations = fit_stations(strands, progress);
  set_guides(stations, guides_of(strands, stations, settings, progress), lod);
  group_by_prism(nearest_guides(stations, lod.guide_strands), lod);
  set_strand_weights(stations, lod);
  add_levels(strands, stations, settings, progress, lod);
  HairWriter writer(strands, stations, settings, lod);
  SharedProgress shared(progress, "lod sections", lod.hair_count());
  parallel_for(lod.hair_count(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t h = begin; h < end; ++h) writer.write(h);
    shared.add(end - begin);
  });
  return lod;
}

}  // namespace pelage
