// What holds for every hierarchy, and what it amounts to.
#include <pelage/animation.h>
#include <pelage/error.h>
#include <pelage/lod.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;
constexpr std::uint32_t kNone = LodHierarchy::kNone;

class Rules {
 public:
  Rules(const LodHierarchy& lod, const std::string& where) : lod_(lod), where_(where) {}

  void check() const {
    check_sizes();
    check_guides();
    check_strands();
    check_tree();
    check_numbers();
  }

 private:
  void require(bool holds, const char* place, const std::string& problem) const {
    if (!holds) throw Error(where_, fmt::format("lod {}", place), problem, "build it again: pelage lod build");
  }

  template <class T>
  void require_size(const std::vector<T>& array, std::size_t size, const char* name) const {
    require(array.size() == size, name, fmt::format("{} entries instead of {}", array.size(), size));
  }

  void check_sizes() const {
    const std::size_t n = lod_.hair_count();
    require(lod_.levels() >= 1 && lod_.levels() <= LodHierarchy::kMostLevels, "levels",
            fmt::format("{} of them", lod_.levels()));
    require(lod_.level_offsets.front() == 0 && lod_.level_offsets.back() == n, "levels", "they do not hold the hairs");
    for (std::size_t l = 0; l < lod_.levels(); ++l)
      require(lod_.level_offsets[l] < lod_.level_offsets[l + 1], "levels", fmt::format("level {} has no hairs", l));
    require(lod_.guide_count() >= 1, "guides", "there are none");
    require_size(lod_.guides, lod_.guide_count() * kPoints, "guides");
    require_size(lod_.prisms, lod_.level_offsets[1], "prisms");
    require_size(lod_.strand_weights, lod_.strand_count(), "strand weights");
    require_size(lod_.weights, n, "weights");
    for (const auto* array : {&lod_.centers, &lod_.major, &lod_.minor}) require_size(*array, n * kPoints, "curves");
    for (const auto* array : {&lod_.major_weights, &lod_.minor_weights})
      require_size(*array, n * kPoints, "weights of corners");
    require_size(lod_.radii, n * kPoints, "radii");
    require_size(lod_.length_ratios, n, "length ratios");
    if (!lod_.twists.empty()) require_size(lod_.twists, n, "twists");
    if (!lod_.colors.empty()) require_size(lod_.colors, n, "colors");
    if (!lod_.root_uv.empty()) require_size(lod_.root_uv, n, "root uv");
  }

  void check_guides() const {
    for (const std::uint32_t strand : lod_.guide_strands)
      require(strand < lod_.strand_count(), "guides", fmt::format("strand {} of {}", strand, lod_.strand_count()));
    for (const auto& p : lod_.prisms)
      require(p[0] <= p[1] && p[1] <= p[2] && p[2] < lod_.guide_count(), "prisms",
              fmt::format("guides {}, {}, {} of {}", p[0], p[1], p[2], lod_.guide_count()));
  }

  void check_strands() const {
    std::vector<bool> seen(lod_.strand_count());
    for (const std::uint32_t s : lod_.order) {
      require(s < seen.size() && !seen[s], "order", "it is no permutation of the strands");
      seen[s] = true;
    }
  }

  void check_tree() const {
    for (std::size_t l = 0; l < lod_.levels(); ++l) {
      std::uint64_t at = 0;
      for (std::uint32_t h = lod_.level_offsets[l]; h < lod_.level_offsets[l + 1]; ++h) {
        const ThickHair& hair = lod_.hairs[h];
        require(hair.first_strand == at && hair.fibers >= 1, "hairs", fmt::format("hair {} does not follow the one before", h));
        at += hair.fibers;
        if (l == 0)
          require(hair.parent == kNone && hair.prism == h, "hairs",
                  fmt::format("hair {} of level 0 has no prism of its own", h));
        check_children(h, l + 1 == lod_.levels());
      }
      require(at == lod_.strand_count(), "hairs",
              fmt::format("level {} stands for {} strands of {}", l, at, lod_.strand_count()));
    }
  }

  void check_children(std::uint32_t h, bool finest) const {
    const ThickHair& hair = lod_.hairs[h];
    const std::string problem = fmt::format("the children of hair {}", h);
    if (finest) return require(hair.children == 0 && hair.first_child == kNone, "hairs", problem);
    require(hair.children >= 1 && hair.first_child > h && hair.first_child < lod_.hair_count() &&
                hair.children <= lod_.hair_count() - hair.first_child,
            "hairs", problem);
    std::uint64_t fibers = 0;
    for (std::uint32_t c = hair.first_child; c < hair.first_child + hair.children; ++c) {
      require(lod_.hairs[c].parent == h && lod_.hairs[c].prism == hair.prism, "hairs", problem);
      fibers += lod_.hairs[c].fibers;
    }
    require(fibers == hair.fibers && lod_.hairs[hair.first_child].first_strand == hair.first_strand, "hairs", problem);
  }

  void check_numbers() const {
    const auto place = [](Vec3 p) {
      return is_finite(p) && std::fmax(std::fmax(std::fabs(p.x), std::fabs(p.y)), std::fabs(p.z)) <= kMaxCoordinate;
    };
    for (const auto* array : {&lod_.guides, &lod_.centers, &lod_.major, &lod_.minor})
      require(std::all_of(array->begin(), array->end(), place), "curves", "a coordinate is not finite");
    const auto share = [](Vec2 w) { return w.x >= 0 && w.y >= 0 && w.x + w.y <= 1.00001f; };
    for (const auto* array : {&lod_.strand_weights, &lod_.weights})
      require(std::all_of(array->begin(), array->end(), share), "weights", "they are no shares of 1");
    const auto finite = [](Vec2 w) { return std::fabs(w.x) <= kMaxCoordinate && std::fabs(w.y) <= kMaxCoordinate; };
    for (const auto* array : {&lod_.major_weights, &lod_.minor_weights, &lod_.root_uv})
      require(std::all_of(array->begin(), array->end(), finite), "weights of corners", "one is not finite");
    require(std::all_of(lod_.radii.begin(), lod_.radii.end(), [](float r) { return r >= 0 && r <= kMaxCoordinate; }), "radii",
            "one is negative or not finite");
    require(
        std::all_of(lod_.length_ratios.begin(), lod_.length_ratios.end(), [](float x) { return x > 0 && x <= kMaxCoordinate; }),
        "length ratios", "one is not positive and finite");
    require(std::all_of(lod_.twists.begin(), lod_.twists.end(), [](float x) { return std::fabs(x) <= kMaxCoordinate; }),
            "twists", "one is not finite");
    const auto color = [](Vec3 c) {
      return std::fmin(std::fmin(c.x, c.y), c.z) >= 0 && std::fmax(std::fmax(c.x, c.y), c.z) <= 1.00001f && is_finite(c);
    };
    require(std::all_of(lod_.colors.begin(), lod_.colors.end(), color), "colors", "one is outside 0…1");
  }

  const LodHierarchy& lod_;
  const std::string& where_;
};

template <class T>
std::size_t bytes_of(const std::vector<T>& array) {
  return array.size() * sizeof(T);
}

}  // namespace

void validate(const LodHierarchy& lod, const std::string& where) {
  Rules(lod, where).check();
  if (lod.animation) validate(*lod.animation, lod.guide_count(), where);
}

void validate(const LodHierarchy& lod, const StrandSet& strands, const std::string& where) {
  validate(lod, where);
  bool same = lod.strand_count() == strands.strand_count();
  for (std::size_t g = 0; same && g < lod.guide_count(); ++g) {
    const std::uint32_t s = lod.guide_strands[g];
    same = lod.guides[g * kPoints] == strands.points[strands.offsets[s]] &&
           lod.guides[g * kPoints + kPoints - 1] == strands.points[strands.offsets[s + 1] - 1];
  }
  if (!same) throw Error(where, "lod", "it was built for other strands", "build it again: pelage lod build");
}

std::size_t resident_bytes(const LodHierarchy& lod) {
  return bytes_of(lod.guide_strands) + bytes_of(lod.guides) + bytes_of(lod.prisms) + bytes_of(lod.order) +
         bytes_of(lod.strand_weights) + bytes_of(lod.level_offsets) + bytes_of(lod.hairs) + bytes_of(lod.weights) +
         bytes_of(lod.centers) + bytes_of(lod.major) + bytes_of(lod.minor) + bytes_of(lod.major_weights) +
         bytes_of(lod.minor_weights) + bytes_of(lod.radii) + bytes_of(lod.length_ratios) + bytes_of(lod.twists) +
         bytes_of(lod.colors) + bytes_of(lod.root_uv);
}

float mean_width(float a, float b) {
  // Ramanujan's second formula for the perimeter, exact for circles and within 0.5 % for any ellipse.
  const float sum = a + b;
  if (!(sum > 0)) return 0;
  const float h = (a - b) * (a - b) / (sum * sum);
  return sum * (1 + 3 * h / (10 + std::sqrt(4 - 3 * h)));
}

std::vector<LodLevelSummary> summarize(const LodHierarchy& lod) {
  std::vector<LodLevelSummary> levels;
  const std::size_t bytes = lod.empty()
                                ? 0
                                : sizeof(ThickHair) + sizeof(Vec2) + sizeof(float) +
                                      kPoints * (3 * sizeof(Vec3) + 2 * sizeof(Vec2) + sizeof(float)) +
                                      (lod.colors.empty() ? 0 : sizeof(Vec3)) + (lod.root_uv.empty() ? 0 : sizeof(Vec2));
  for (std::size_t l = 0; l < lod.levels(); ++l) {
    LodLevelSummary s;
    s.hairs = lod.level(l).size(), s.segments = s.hairs * (kPoints - 1), s.bytes = s.hairs * bytes;
    s.mean_fibers = static_cast<double>(lod.strand_count()) / static_cast<double>(s.hairs);
    for (std::size_t h = lod.level_offsets[l]; h < lod.level_offsets[l + 1]; ++h) {
      const std::uint32_t fibers = lod.hairs[h].fibers;
      s.most_fibers = std::max<std::size_t>(s.most_fibers, fibers);
      const double share = static_cast<double>(fibers) / (static_cast<double>(lod.strand_count()) * kPoints);
      for (std::size_t i = h * kPoints; i < (h + 1) * kPoints; ++i) {
        const float a = length(lod.major[i]), b = length(lod.minor[i]), r = lod.radii[i];
        s.mean_area += share * std::numbers::pi * static_cast<double>(a) * static_cast<double>(b);
        s.mean_width += share * static_cast<double>(mean_width(a, b));
        if (a * b > 0)
          s.mean_density +=
              share * std::min(1., static_cast<double>(fibers) * static_cast<double>(r / a) * static_cast<double>(r / b));
      }
    }
    levels.push_back(s);
  }
  return levels;
}

StrandSet extract_level(const LodHierarchy& lod, std::size_t level) {
  if (level >= lod.levels())
    throw Error("lod", "level", fmt::format("{} of {} levels", level, lod.levels()),
                fmt::format("levels are 0 … {}", lod.levels() - 1));
  StrandSet set;
  set.basis = CurveBasis::kBSpline;
  const std::size_t first = lod.level_offsets[level], end = lod.level_offsets[level + 1];
  set.points.assign(lod.centers.begin() + static_cast<std::ptrdiff_t>(first * kPoints),
                    lod.centers.begin() + static_cast<std::ptrdiff_t>(end * kPoints));
  set.offsets = {0};
  for (std::size_t h = first; h < end; ++h) {
    set.offsets.push_back(static_cast<std::uint32_t>((h + 1 - first) * kPoints));
    for (std::size_t i = h * kPoints; i < (h + 1) * kPoints; ++i)
      set.widths.push_back(mean_width(length(lod.major[i]), length(lod.minor[i])));
  }
  const auto slice = [&](const auto& from, auto& to) {
    if (!from.empty())
      to.assign(from.begin() + static_cast<std::ptrdiff_t>(first), from.begin() + static_cast<std::ptrdiff_t>(end));
  };
  slice(lod.colors, set.colors), slice(lod.root_uv, set.root_uv);
  return set;
}

}  // namespace pelage
