#include "assemble/clip.h"

#include <array>
#include <vector>

namespace pelage {
namespace {

using Point = ClipPoint;

/// Signed "distances" from the five planes; all ≥ 0 inside. Linear in camera space, so a cut is a ratio of two.
std::array<double, 5> distances(const CameraView& v, const Point& p) {
  const double w = v.perspective ? p.z : 1.0, f = v.focal;
  return {p.z - static_cast<double>(v.near_plane), f * p.x + (v.center_x + static_cast<double>(kGuardBand)) * w,
          f * -p.x + (static_cast<double>(v.width) + kGuardBand - v.center_x) * w,
          f * p.y + (v.center_y + static_cast<double>(kGuardBand)) * w,
          f * -p.y + (static_cast<double>(v.height) + kGuardBand - v.center_y) * w};
}

Point lerp(const Point& a, const Point& b, double t) {
  if (t == 1) return b;
  return {a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.z + (b.z - a.z) * t, a.radius + (b.radius - a.radius) * t};
}

/// The inside part [t0, t1] of a → b (Liang & Barsky 1984; references.bib: Liang1984Clipping); false when there is none.
bool inside_part(const CameraView& view, const Point& a, const Point& b, double& t0, double& t1) {
  const auto da = distances(view, a), db = distances(view, b);
  t0 = 0, t1 = 1;
  for (std::size_t i = 0; i < da.size(); ++i) {
    if (da[i] < 0 && db[i] < 0) return false;
    if (da[i] < 0) t0 = std::max(t0, da[i] / (da[i] - db[i]));
    if (db[i] < 0) t1 = std::min(t1, da[i] / (da[i] - db[i]));
  }
  return t0 < t1;
}

void append(ScreenBlock& block, const CameraView& view, const Point& p, std::uint32_t id) {
  const std::size_t at = block.count++;
  block.x[at] = static_cast<float>(p.x), block.y[at] = static_cast<float>(p.y);
  block.depth[at] = std::max(static_cast<float>(p.z), view.near_plane);
  block.radius[at] = static_cast<float>(p.radius);
  block.id[at] = id;
}

}  // namespace

bool clip_segment(const CameraView& view, ClipPoint& a, ClipPoint& b) {
  double t0, t1;
  if (!inside_part(view, a, b, t0, t1)) return false;
  const ClipPoint from = t0 == 0 ? a : lerp(a, b, t0);
  b = lerp(a, b, t1), a = from;
  return true;
}

void clip(const AssembleJob& job, ScreenBlock& block) {
  struct Input {
    Point p;
    std::uint32_t id;
  };
  std::vector<Input> in(block.count);
  for (std::size_t i = 0; i < block.count; ++i)
    in[i] = {{block.x[i], block.y[i], block.depth[i], block.radius[i]}, block.id[i]};
  // Each segment may become a run of its own.
  const std::size_t most = 2 * in.size();
  if (block.x.size() < most + ScreenBlock::kPadding) {
    ScreenBlock larger;
    larger.id.resize(most + ScreenBlock::kPadding), larger.id.fill(ScreenBlock::kNoSegment);
    for (Buffer<float> ScreenBlock::*b : {&ScreenBlock::x, &ScreenBlock::y, &ScreenBlock::depth, &ScreenBlock::radius,
                                          &ScreenBlock::cap_x, &ScreenBlock::cap_y})
      (larger.*b).resize(most + ScreenBlock::kPadding), (larger.*b).fill(1.f);
    block = std::move(larger);
  }
  block.count = 0;
  bool open = false;  // the last point written waits for its segment's end
  for (std::size_t i = 0; i + 1 < in.size(); ++i) {
    if (in[i].id == ScreenBlock::kNoSegment) continue;
    double t0, t1;
    if (!inside_part(job.view, in[i].p, in[i + 1].p, t0, t1)) continue;
    if (open && t0 == 0) block.id[block.count - 1] = in[i].id;
    else append(block, job.view, lerp(in[i].p, in[i + 1].p, t0), in[i].id);
    append(block, job.view, lerp(in[i].p, in[i + 1].p, t1), ScreenBlock::kNoSegment);
    open = t1 == 1 && in[i + 1].id != ScreenBlock::kNoSegment;
  }
}

}  // namespace pelage
