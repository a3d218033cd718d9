#include "groom/hairmesh/column_paths.h"

#include <algorithm>
#include <cmath>

#include "groom/collide.h"
#include "groom/head_shape.h"
#include "groom/mannequin.h"
#include "groom/noise.h"
#include "groom/scalp.h"
#include "groom/sdf.h"

namespace pelage::groom {
namespace {

constexpr float kStep = 0.003f;
constexpr float kUnderHair = 0.004f;  // metres between skin and cage: quads cut the curve of the skull by 1 to 2 mm
constexpr float kBeside = 0.015f;     // metres from the parting at which its flow leads to one side for sure
constexpr float kLoose = 0.005f;      // metres above its layer in which hair of the crown is left alone
constexpr float kSmoothed = 12;       // passes over a path
constexpr Vec3 kTie{0, 0.052f, -0.124f};

void smooth(std::vector<Vec3>& p, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    Vec3 before = p[0];
    for (std::size_t i = 1; i + 1 < p.size(); ++i) {
      const Vec3 here = p[i];
      p[i] = before * 0.25f + here * 0.5f + p[i + 1] * 0.25f;
      before = here;
    }
  }
}

Vec3 clear_of_head(Vec3 p, float clearance) { return push_out(mannequin().grid, p, clearance); }

/// The pull of a shoulder on what comes down on it, along z: forward or backward.
float shoulder_pull(Vec3 p, bool behind) {
  const float near_shoulder = smoothstep(-0.06f, -0.13f, p.y) * smoothstep(0.02f, 0.05f, std::abs(p.x));
  return near_shoulder * (behind ? -smoothstep(-0.110f, -0.06f, p.z) : smoothstep(0.075f, 0.035f, p.z));
}

/// The pull on hair that hangs before the temples, back beside the face.
float sweep_back(Vec3 p) {
  return smoothstep(0.04f, 0.085f, p.z) * smoothstep(0.09f, 0.05f, p.y) * smoothstep(-0.17f, -0.11f, p.y);
}

class Faller {
 public:
  Faller(const ScalpColumn& column, const Fall& fall) : c_(column), f_(fall) {}

  std::vector<Vec3> path() const {
    std::vector<Vec3> points{c_.root};
    Vec3 p = c_.root, direction = first_direction();
    const float cut =
        mix(f_.cut_front, f_.cut_back, smoothstep(0.15f, 0.85f, c_.along)) + f_.ragged * noise3(c_.root * 60.f, 51u);
    for (float s = kStep; s < f_.length && p.y > cut; s += kStep) {
      direction = normalize(direction + pull(p, s) * (kStep / f_.bend_length));
      Vec3 next = laid(p + direction * kStep, clearance(s));
      next = push_out_of_face(next, smoothstep(0.f, 0.04f, s));
      direction = normalize(next - p);
      p = p + direction * kStep;
      points.push_back(p);
    }
    if (points.size() < 3) points.push_back(p + direction * kStep), points.push_back(p + direction * (2 * kStep));
    smooth(points, static_cast<int>(kSmoothed));
    for (std::size_t i = 1; i < points.size(); ++i)
      points[i] = clear_of_head(points[i], std::min(0.5f * kStep * static_cast<float>(i), kUnderHair));
    return points;
  }

 private:
  Vec3 first_direction() const {
    if (c_.side == 0 && c_.down == 0 && c_.along < 0.45f)
      return normalize(c_.normal * f_.lift + Vec3(0, -0.3f, -1) * (1 - f_.lift));
    const Vec3 beside = c_.root + Vec3(kBeside * static_cast<float>(c_.side), 0, 0);
    const Vec3 flow = normalize(parting_flow(beside, c_.normal, f_.parting_x));
    const float lift = c_.side != 0 ? 0.5f * f_.lift : f_.lift;
    return normalize(c_.normal * lift + flow * (1 - lift));
  }
  /// Not below the layer that hair lies in, and over the crown not far above it: the skull curves away under it.
  Vec3 laid(Vec3 p, float layer) const {
    const DistanceSample skin = sample_distance(mannequin().grid, p);
    const float above = skin.distance - layer, too_far = std::max(above - kLoose, 0.f);
    const float down = above < 0 ? above : too_far * f_.cling * smoothstep(0.02f, 0.07f, p.y);
    return p - normalize(skin.gradient) * down;
  }
  Vec3 pull(Vec3 p, float s) const {
    Vec3 sum(0, -smoothstep(0.f, f_.bend_length, s), 0);
    sum += Vec3(0, 0, shoulder_pull(p, c_.behind) * 1.4f - sweep_back(p) * 1.6f);
    // Hair in front of the shoulders leaves the throat free.
    const float throat = smoothstep(0.10f, 0.06f, std::abs(p.x)) * smoothstep(0.01f, -0.05f, p.y);
    if (!c_.behind) sum.x += std::copysign(2.5f * throat, p.x);
    const Vec3 out = normalize(Vec3(p.x, 0, p.z + 0.02f));
    sum += out * (f_.spread * smoothstep(0.10f, 0.0f, p.y) * smoothstep(-0.2f, 0.f, p.y));
    return sum - out * (f_.tuck * smoothstep(-0.045f, -0.10f, p.y));
  }
  /// What grows higher lies further out.
  float clearance(float s) const {
    const float layer = f_.volume * mix(1, 0.2f, c_.down) * smoothstep(0.01f, 0.13f, s);
    return std::min(0.5f * s, kUnderHair + layer);
  }

  const ScalpColumn& c_;
  const Fall& f_;
};

/// Directions from the middle of the skull in polar coordinates around that of the tie.
struct AroundTie {
  Vec3 pole = normalize(kTie - kSkullCenter);
  Vec3 left = normalize(cross(Vec3(0, 1, 0), pole) * -1.f), up = cross(pole, left) * -1.f;
  /// Angle from the tie, and the unit vector in the plane across it.
  float angle(Vec3 d) const { return std::acos(std::clamp(dot(d, pole), -1.f, 1.f)); }
  Vec2 heading(Vec3 d) const {
    const Vec2 h(dot(d, left), dot(d, up));
    return h * (1 / std::max(length(h), 1e-6f));
  }
  Vec3 direction(float angle, Vec2 heading) const {
    return pole * std::cos(angle) + (left * heading.x + up * heading.y) * std::sin(angle);
  }
};
constexpr float kFarthest = 2.35f;  // radians from the tie to the forehead's hairline

/// Middle of the tail, `hung` metres behind the tie: out of it backward, then down.
Vec3 tail_middle(float hung) {
  // A hanging curve: the direction turns from backward to down over a few centimetres.
  constexpr float kTurn = 0.045f;
  Vec3 p = kTie;
  const int steps = 64;
  for (int i = 0; i < steps; ++i) {
    const float s = hung * (static_cast<float>(i) + 0.5f) / static_cast<float>(steps);
    const Vec3 direction = normalize(lerp(Vec3(0, 0.25f, -1), Vec3(0, -1, 0.03f), smoothstep(-0.2f * kTurn, 1.7f * kTurn, s)));
    p += direction * (hung / static_cast<float>(steps));
  }
  return p;
}

}  // namespace

std::vector<Vec3> fall_path(const ScalpColumn& column, const Fall& fall) { return Faller(column, fall).path(); }

std::vector<Vec3> ball_path(const ScalpColumn& column, float radius) {
  // Out from a point low in the head, so that hair of the nape does not hang; the ball itself is wider than high.
  const Vec3 middle(0, 0.052f, -0.022f), radii = Vec3(1.f, 0.93f, 0.98f) * radius;
  const Vec3 way = normalize(column.root - Vec3(0, 0.012f, -0.014f));
  const Vec3 o = (column.root - middle) / radii, d = way / radii;
  const float b = dot(o, d), t = (-b + std::sqrt(std::max(b * b - dot(d, d) * (dot(o, o) - 1), 0.f))) / dot(d, d);
  std::vector<Vec3> points;
  constexpr int kPoints = 32;
  for (int i = 0; i <= kPoints; ++i) points.push_back(column.root + way * (t * static_cast<float>(i) / kPoints));
  return points;
}

Vec2 tail_place(Vec3 root) {
  const AroundTie around;
  const Vec3 d = normalize(root - kSkullCenter);
  return around.heading(d) * std::min(around.angle(d) / kFarthest, 1.f);
}

TiedPath tied_path(const ScalpColumn& column, const Tie& tie, Vec2 place) {
  const AroundTie around;
  const Vec3 from = normalize(column.root - kSkullCenter);
  const float angle = around.angle(from);
  const Vec2 heading = around.heading(from);
  const Vec3 gate = kTie + (around.left * place.x + around.up * place.y) * tie.waist;
  TiedPath path;
  path.to_tie.push_back(column.root);
  constexpr int kPoints = 40;
  for (int i = 1; i < kPoints; ++i) {
    const float t = static_cast<float>(i) / kPoints;
    const Vec3 on_skin = skin_along(kSkullCenter, around.direction(angle * (1 - t), heading));
    const float lift = mix(kUnderHair, kUnderHair + tie.lift, length(place)) * smoothstep(0.f, 0.25f, t);
    const Vec3 over_skin = on_skin + head_normal(on_skin) * lift;
    path.to_tie.push_back(lerp(over_skin, gate, smoothstep(0.6f, 1.f, t)));
  }
  path.to_tie.push_back(gate);
  smooth(path.to_tie, 10);
  for (int i = 0; i <= kPoints; ++i) {
    const float t = static_cast<float>(i) / kPoints;
    const float swell = mix(tie.waist, tie.radius, smoothstep(0.f, 0.3f, t)) * mix(1, tie.tip, smoothstep(0.35f, 1.f, t));
    // Across the tail: to the left, and away from the head.
    const float hung = tie.length * t;
    const Vec3 along = normalize(tail_middle(hung + 1e-3f) - tail_middle(hung));
    const Vec3 across = normalize(cross(along, around.left) * -1.f);
    path.tail.push_back(tail_middle(hung) + (around.left * place.x + across * place.y) * swell);
  }
  return path;
}

std::vector<Vec3> resample(const std::vector<Vec3>& path, int layers, float denser_at_root) {
  std::vector<float> length_to{0};
  for (std::size_t i = 1; i < path.size(); ++i) length_to.push_back(length_to.back() + length(path[i] - path[i - 1]));
  std::vector<Vec3> points;
  std::size_t i = 0;
  for (int k = 0; k < layers; ++k) {
    const float w = static_cast<float>(k) / static_cast<float>(layers - 1);
    const float s = length_to.back() * (w * (1 - denser_at_root) + w * w * denser_at_root);
    while (i + 2 < path.size() && length_to[i + 1] < s) ++i;
    const float span = length_to[i + 1] - length_to[i];
    points.push_back(lerp(path[i], path[i + 1], span > 0 ? saturate((s - length_to[i]) / span) : 0.f));
  }
  return points;
}

}  // namespace pelage::groom
