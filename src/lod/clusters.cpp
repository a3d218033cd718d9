#include "lod/clusters.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/k_means.h"
#include "core/parallel.h"
#include "lod/cross_section.h"

namespace pelage {
namespace {

using Strands = std::vector<std::uint32_t>;

struct Part {
  Strands strands;
  double area;  ///< of the thick hair that stands for them
  double weight() const { return area * static_cast<double>(strands.size()); }
};

class Divider {
 public:
  Divider(const Stations& stations, const LodSettings& settings) : stations_(stations), settings_(settings) {}

  /// The strands in one part or more, by their first strands.
  std::vector<Strands> divide(Strands strands) const {
    const std::size_t count = strands.size();
    std::vector<Part> parts;
    parts.push_back(part(std::move(strands)));
    const double target = parts[0].area / static_cast<double>(settings_.area_ratio);
    double area = parts[0].area;
    while (area > target && parts.size() < kMostParts) {
      const auto widest = std::max_element(parts.begin(), parts.end(),
                                           [](const Part& a, const Part& b) { return divisible(a) < divisible(b); });
      if (divisible(*widest) <= 0) break;
      std::vector<Part> two = halves(*widest);
      if (two.size() < 2) {  // all in the same place
        widest->area = 0;
        continue;
      }
      const double next = area + (two[0].weight() + two[1].weight() - widest->weight()) / static_cast<double>(count);
      // The last step goes beyond the target; it is left out where that is farther off.
      if (next < target && parts.size() > 1 && target / next > area / target) break;
      area = next;
      *widest = std::move(two[0]);
      parts.push_back(std::move(two[1]));
    }
    return sorted(std::move(parts));
  }

 private:
  static double divisible(const Part& p) { return p.strands.size() > 1 ? p.weight() : 0; }

  Part part(Strands strands) const {
    const double area = static_cast<double>(mean_area(fit_cross_sections(stations_, strands, settings_.covered, false)));
    return {std::move(strands), area};
  }

  std::vector<Part> halves(const Part& whole) const {
    std::vector<Part> out;
    if (whole.strands.size() == 2) {
      out.push_back(part({whole.strands[0]}));
      out.push_back(part({whole.strands[1]}));
      return out;
    }
    Features f;
    f.dimension = 3 * Stations::kPoints;
    f.values.reserve(whole.strands.size() * f.dimension);
    for (const std::uint32_t s : whole.strands)
      for (std::size_t k = 0; k < Stations::kPoints; ++k) {
        const Vec3 p = stations_.strand(s)[k];
        f.values.insert(f.values.end(), {p.x, p.y, p.z});
      }
    const std::vector<std::uint32_t> label = k_means(f, 2, settings_.seed);
    Strands side[2];
    for (std::size_t i = 0; i < label.size(); ++i) side[label[i]].push_back(whole.strands[i]);
    for (Strands& s : side)
      if (!s.empty()) out.push_back(part(std::move(s)));
    return out;
  }

  static std::vector<Strands> sorted(std::vector<Part> parts) {
    std::vector<Strands> out;
    for (Part& p : parts) out.push_back(std::move(p.strands));
    std::sort(out.begin(), out.end());
    return out;
  }

  const Stations& stations_;
  const LodSettings& settings_;
};

}  // namespace

void group_by_prism(const std::vector<Prism>& nearest, LodHierarchy& lod) {
  lod.order.resize(nearest.size());
  std::iota(lod.order.begin(), lod.order.end(), 0u);
  std::stable_sort(lod.order.begin(), lod.order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return nearest[a] < nearest[b]; });
  for (std::uint32_t i = 0; i < lod.order.size(); ++i) {
    const Prism& prism = nearest[lod.order[i]];
    if (lod.prisms.empty() || lod.prisms.back() != prism) {
      ThickHair hair;
      hair.first_strand = i, hair.prism = static_cast<std::uint32_t>(lod.prisms.size());
      hair.parent = hair.first_child = LodHierarchy::kNone;
      lod.prisms.push_back(prism), lod.hairs.push_back(hair);
    }
    ++lod.hairs.back().fibers;
  }
  lod.level_offsets = {0, static_cast<std::uint32_t>(lod.hairs.size())};
}

void divide_finest_level(const Stations& stations, const LodSettings& settings, LodHierarchy& lod) {
  const std::uint32_t first = lod.level_offsets[lod.levels() - 1], count = lod.level_offsets.back() - first;
  const Divider divider(stations, settings);
  std::vector<std::vector<Strands>> parts(count);
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const ThickHair& hair = lod.hairs[first + i];
      const auto strands = lod.order.begin() + hair.first_strand;
      parts[i] = divider.divide(Strands(strands, strands + hair.fibers));
    }
  });
  for (std::uint32_t i = 0; i < count; ++i) {
    lod.hairs[first + i].first_child = static_cast<std::uint32_t>(lod.hairs.size());
    lod.hairs[first + i].children = static_cast<std::uint32_t>(parts[i].size());
    std::uint32_t at = lod.hairs[first + i].first_strand;
    for (const Strands& strands : parts[i]) {
      ThickHair child;
      child.first_strand = at, child.fibers = static_cast<std::uint32_t>(strands.size());
      child.parent = first + i, child.prism = lod.hairs[first + i].prism, child.first_child = LodHierarchy::kNone;
      lod.hairs.push_back(child);
      std::copy(strands.begin(), strands.end(), lod.order.begin() + at);
      at += child.fibers;
    }
  }
  lod.level_offsets.push_back(static_cast<std::uint32_t>(lod.hairs.size()));
}

}  // namespace pelage
