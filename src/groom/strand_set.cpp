#include <pelage/error.h>
#include <pelage/strand_set.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <numeric>

#include "core/parallel.h"

namespace pelage {
namespace {

template <class T>
std::size_t held(const std::vector<T>& array) {
  return array.capacity() * sizeof(T);
}

// Also false for NaN.
bool usable(float x) { return std::fabs(x) <= kMaxCoordinate; }
bool usable(Vec3 p) { return usable(p.x) && usable(p.y) && usable(p.z); }
bool usable_width(float width) { return width >= 0 && width <= kMaxCoordinate; }

// Names the first broken invariant; validate() is the list of them.
class Validator {
 public:
  Validator(const StrandSet& set, const std::string& where) : set_(set), where_(where) {}

  void partition() const {
    const std::vector<std::uint32_t>& offsets = set_.offsets;
    if (offsets.empty()) {
      if (!set_.points.empty()) fail("offsets", "empty, but there are points");
      return;
    }
    if (offsets.front() != 0) fail("offsets", fmt::format("the first is {}, not 0", offsets.front()));
    if (offsets.back() != set_.point_count())
      fail("offsets", fmt::format("the last is {}, but there are {} points", offsets.back(), set_.point_count()));
    for (std::size_t s = 0; s + 1 < offsets.size(); ++s) {
      if (offsets[s] > offsets[s + 1]) fail(strand(s), "its offset lies after the next strand's");
      const std::uint32_t count = offsets[s + 1] - offsets[s];
      if (count < 2) fail(strand(s), fmt::format("{} points, at least 2 are needed", count));
      if (set_.basis == CurveBasis::kBezier && count % 3 != 1)
        fail(strand(s), fmt::format("{} points, a Bézier strand has 3k+1", count));
    }
  }

  template <class T>
  void size(const std::vector<T>& array, const char* name, bool single, bool per_strand, bool per_point) const {
    const std::size_t n = array.size();
    if (n == 0 || (single && n == 1) || (per_strand && n == set_.strand_count()) || (per_point && n == set_.point_count()))
      return;
    fail(name, fmt::format("{} entries for {} strands of {} points", n, set_.strand_count(), set_.point_count()));
  }

  template <class T, class Good>
  void values(const std::vector<T>& array, const char* name, const char* rule, const Good& good) const {
    for (std::size_t i = 0; i < array.size(); ++i)
      if (!good(array[i])) fail(fmt::format("{}[{}]", name, i), rule);
  }

 private:
  static std::string strand(std::size_t s) { return fmt::format("strand {}", s); }
  [[noreturn]] void fail(const std::string& place, const std::string& problem) const {
    throw Error(where_, place, problem, "repair() mends strands one by one");
  }
  const StrandSet& set_;
  const std::string& where_;
};

bool in_unit(float x) { return x >= 0 && x <= 1; }
bool good_color(Vec3 c) { return in_unit(c.x) && in_unit(c.y) && in_unit(c.z); }
bool good_uv(Vec2 uv) { return usable(uv.x) && usable(uv.y); }

constexpr float kDefaultColor = 0.5f;
constexpr float kDefaultWidth = 8e-5f;  // human hair, where a groom has not one usable width

float clamped(float x, float fallback) { return std::isnan(x) ? fallback : std::clamp(x, 0.f, 1.f); }

template <class T, class Good, class Mend>
std::size_t mend(std::vector<T>& array, const Good& good, const Mend& mended) {
  std::size_t bad = 0;
  for (T& value : array) {
    if (good(value)) continue;
    value = mended(value);
    ++bad;
  }
  return bad;
}

std::size_t mend_attributes(StrandSet& set) {
  const auto mended_color = [](Vec3 c) {
    return Vec3(clamped(c.x, kDefaultColor), clamped(c.y, kDefaultColor), clamped(c.z, kDefaultColor));
  };
  return mend(set.colors, good_color, mended_color) + mend(set.transparency, in_unit, [](float t) { return clamped(t, 0); }) +
         mend(set.root_uv, good_uv, [](Vec2) { return Vec2(); }) +
         mend(
             set.guide_id, [](std::int32_t g) { return g >= -1; }, [](std::int32_t) { return -1; });
}

float median_of_good(const float* begin, const float* end, float fallback) {
  std::vector<float> good;
  std::copy_if(begin, end, std::back_inserter(good), usable_width);
  if (good.empty()) return fallback;
  const auto middle = good.begin() + static_cast<std::ptrdiff_t>(good.size() / 2);
  std::nth_element(good.begin(), middle, good.end());
  return *middle;
}

std::size_t mend_widths(StrandSet& set) {
  std::vector<float>& widths = set.widths;
  const auto bad =
      static_cast<std::size_t>(std::count_if(widths.begin(), widths.end(), [](float width) { return !usable_width(width); }));
  if (bad == 0) return 0;
  const float fallback = median_of_good(widths.data(), widths.data() + widths.size(), kDefaultWidth);
  if (widths.size() != set.point_count()) {
    widths.assign(1, fallback);
    return bad;
  }
  for (std::size_t s = 0; s < set.strand_count(); ++s) {
    float* const begin = widths.data() + set.offsets[s];
    float* const end = widths.data() + set.offsets[s + 1];
    if (std::all_of(begin, end, usable_width)) continue;
    const float median = median_of_good(begin, end, fallback);
    std::replace_if(
        begin, end, [](float width) { return !usable_width(width); }, median);
  }
  return bad;
}

bool zero_length(Vec3 a, Vec3 b) {
  const Vec3 d = b - a;
  return !(dot(d, d) > 0);
}

// Copies what is kept down over what is dropped. Arrays per point and per strand move in step.
class Compactor {
 public:
  Compactor(StrandSet& set, RepairReport& report) : set_(set), report_(report) {}

  void run() {
    const std::size_t strands = set_.strand_count(), points = set_.point_count();
    widths_ = set_.widths.size() == points && points > 1;
    point_colors_ = !set_.colors.empty() && set_.colors.size() == points;
    std::uint32_t begin = 0;
    for (std::size_t s = 0; s < strands; ++s) {
      const std::uint32_t end = set_.offsets[s + 1], kept_before = kept_points_;
      const std::uint32_t usable_points = keep_points(begin, end);
      begin = end;
      finish_strand(s, kept_before, usable_points);
    }
    truncate(strands, points);
  }

 private:
  // Return how many of the strand's points are usable.
  std::uint32_t keep_points(std::uint32_t begin, std::uint32_t end) {
    if (set_.basis == CurveBasis::kBezier) return keep_spans(begin, end);
    const std::uint32_t first = kept_points_;
    std::uint32_t usable_points = 0, repeated = 0;
    for (std::uint32_t i = begin; i < end; ++i) {
      if (!usable(set_.points[i])) continue;
      ++usable_points;
      if (kept_points_ > first && zero_length(set_.points[kept_points_ - 1], set_.points[i])) ++repeated;
      else move_point(i);
    }
    report_.non_finite_points += end - begin - usable_points;
    if (kept_points_ - first >= 2) report_.zero_length_segments += repeated;  // else the whole strand is counted
    return usable_points;
  }

  // Control points of a Bézier strand may repeat; whole spans of usable points are kept.
  std::uint32_t keep_spans(std::uint32_t begin, std::uint32_t end) {
    std::uint32_t good = begin;
    while (good < end && usable(set_.points[good])) ++good;
    for (std::uint32_t i = good; i < end; ++i) report_.non_finite_points += !usable(set_.points[i]);
    const std::uint32_t count = good > begin ? (good - begin - 1) / 3 * 3 + 1 : 0;
    if (good == end) report_.partial_spans += end - begin - count;
    for (std::uint32_t i = begin; i < begin + count; ++i) move_point(i);
    return count;
  }

  void move_point(std::uint32_t from) {
    set_.points[kept_points_] = set_.points[from];
    if (widths_) set_.widths[kept_points_] = set_.widths[from];
    if (point_colors_) set_.colors[kept_points_] = set_.colors[from];
    if (!set_.transparency.empty()) set_.transparency[kept_points_] = set_.transparency[from];
    ++kept_points_;
  }

  void finish_strand(std::size_t s, std::uint32_t first, std::uint32_t usable_points) {
    if (drop(first, usable_points)) {
      kept_points_ = first;
      if (report_.dropped.size() < kListed) report_.dropped.push_back(static_cast<std::uint32_t>(s));
      if (set_.strand_id.empty()) name_strands();
      return;
    }
    const auto move = [&](auto& array) {
      if (!array.empty()) array[kept_strands_] = array[s];
    };
    if (!point_colors_) move(set_.colors);
    move(set_.root_uv), move(set_.strand_id), move(set_.guide_id), move(set_.group);
    set_.offsets[++kept_strands_] = kept_points_;
  }

  // Counts the reason. `usable_points` are those that were there before repeated ones went.
  bool drop(std::uint32_t first, std::uint32_t usable_points) {
    const std::uint32_t count = kept_points_ - first;
    const auto points = set_.points.begin();
    const bool has_length =
        std::any_of(points + first, points + kept_points_, [&](Vec3 p) { return !zero_length(*(points + first), p); });
    if (has_length) return false;
    ++(usable_points >= 2 && count >= 1 ? report_.degenerate_strands : report_.short_strands);
    return true;
  }

  // Before the first strand goes, the index is the name; afterwards it has to be written down.
  void name_strands() {
    set_.strand_id.resize(set_.strand_count());
    std::iota(set_.strand_id.begin(), set_.strand_id.end(), 0u);
  }

  void truncate(std::size_t strands, std::size_t points) {
    const auto cut = [](auto& array, std::size_t before, std::size_t after) {
      if (array.size() == before) array.resize(after);
    };
    if (widths_) set_.widths.resize(kept_points_);
    if (point_colors_) set_.colors.resize(kept_points_);
    else cut(set_.colors, strands, kept_strands_);
    cut(set_.transparency, points, kept_points_);
    cut(set_.root_uv, strands, kept_strands_), cut(set_.strand_id, strands, kept_strands_);
    cut(set_.guide_id, strands, kept_strands_), cut(set_.group, strands, kept_strands_);
    set_.points.resize(kept_points_);
    set_.offsets.resize(kept_strands_ + 1);
  }

  static constexpr std::size_t kListed = 1000;  // of RepairReport::dropped
  StrandSet& set_;
  RepairReport& report_;
  std::uint32_t kept_points_ = 0;
  std::size_t kept_strands_ = 0;
  bool widths_ = false, point_colors_ = false;
};

bool strand_is_sound(const StrandSet& set, std::size_t s) {
  const std::uint32_t begin = set.offsets[s], end = set.offsets[s + 1];
  const bool bezier = set.basis == CurveBasis::kBezier;
  if (end - begin < 2 || (bezier && (end - begin) % 3 != 1) || !usable(set.points[begin])) return false;
  bool has_length = false, repeats = false;
  for (std::uint32_t i = begin + 1; i < end; ++i) {
    if (!usable(set.points[i])) return false;
    const bool zero = zero_length(set.points[i - 1], set.points[i]);
    has_length |= !zero, repeats |= zero;
  }
  return has_length && (bezier || !repeats);
}

bool strands_are_sound(const StrandSet& set) {
  std::atomic<bool> sound{true};
  parallel_for(set.strand_count(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end && sound.load(std::memory_order_relaxed); ++s)
      if (!strand_is_sound(set, s)) sound.store(false, std::memory_order_relaxed);
  });
  return sound;
}

}  // namespace

bool RepairReport::clean() const {
  return non_finite_points + short_strands + zero_length_segments + degenerate_strands + partial_spans + bad_widths +
             bad_attributes ==
         0;
}

std::string RepairReport::summary() const {
  std::string line;
  const auto add = [&](std::size_t count, const char* one, const char* many, const char* fate) {
    if (count) line += fmt::format("{}{} {} {}", line.empty() ? "" : ", ", count, count == 1 ? one : many, fate);
  };
  add(non_finite_points, "non-finite point", "non-finite points", "removed");
  add(short_strands, "strand of fewer than two points", "strands of fewer than two points", "dropped");
  add(degenerate_strands, "strand of no length", "strands of no length", "dropped");
  add(zero_length_segments, "zero-length segment", "zero-length segments", "removed");
  add(partial_spans, "point after the last whole Bézier span", "points after the last whole Bézier span", "removed");
  add(bad_widths, "bad width", "bad widths", "replaced");
  add(bad_attributes, "bad attribute value", "bad attribute values", "replaced");
  return line.empty() ? "no repairs" : line;
}

void validate(const StrandSet& strands, const std::string& where) {
  const Validator check(strands, where);
  check.partition();
  check.size(strands.widths, "widths", true, false, true);
  check.size(strands.colors, "colors", false, true, true);
  check.size(strands.transparency, "transparency", false, false, true);
  check.size(strands.root_uv, "root_uv", false, true, false);
  check.size(strands.strand_id, "strand_id", false, true, false);
  check.size(strands.guide_id, "guide_id", false, true, false);
  check.size(strands.group, "group", false, true, false);
  if (strands.widths.empty() && strands.strand_count() > 0)
    throw Error(where, "widths", "none", "give at least one width for all");
  check.values(strands.points, "points", "not finite, or beyond 1e15 m", [](Vec3 p) { return usable(p); });
  check.values(strands.widths, "widths", "not a finite number of 0 or more", usable_width);
  check.values(strands.colors, "colors", "not in 0…1", good_color);
  check.values(strands.transparency, "transparency", "not in 0…1", in_unit);
  check.values(strands.root_uv, "root_uv", "not finite", good_uv);
  check.values(strands.guide_id, "guide_id", "below −1", [](std::int32_t g) { return g >= -1; });
}

RepairReport repair(StrandSet& strands) {
  RepairReport report;
  report.bad_attributes = mend_attributes(strands);
  report.bad_widths = mend_widths(strands);
  if (!strands_are_sound(strands)) Compactor(strands, report).run();
  return report;
}

Bounds bounds(const StrandSet& strands) {
  Bounds b;
  for (const Vec3 p : strands.points) b.extend(p);
  return b;
}

std::size_t resident_bytes(const StrandSet& s) {
  return held(s.points) + held(s.offsets) + held(s.widths) + held(s.colors) + held(s.transparency) + held(s.root_uv) +
         held(s.strand_id) + held(s.guide_id) + held(s.group) + s.comment.capacity();
}

}  // namespace pelage
