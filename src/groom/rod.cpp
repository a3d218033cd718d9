#include "groom/rod.h"

#include <algorithm>
#include <cmath>

#include "groom/collide.h"
#include "groom/noise.h"

namespace pelage::groom {
namespace {

constexpr std::size_t kFirstFree = 2;

constexpr std::size_t kWindow = Rod::kWindow;
constexpr float kPinned = 100;  // how much more a point that goes with the head weighs in a window

/// x of A·x = b, A symmetric, by its rows; `fallback` where A is not positive definite.
Vec3 solve_positive(Vec3 row0, Vec3 row1, Vec3 row2, Vec3 b, Vec3 fallback) {
  const Vec3 c0 = cross(row1, row2), c1 = cross(row2, row0), c2 = cross(row0, row1);
  const float determinant = dot(row0, c0);
  if (!(row0.x > 0 && c2.z > 0 && determinant > 0)) return fallback;
  return (c0 * b.x + c1 * b.y + c2 * b.z) / determinant;
}

/// The rotation that takes `rest` nearest to `now`, both about their centers, from one that is close: Newton's method on Σ w|R·rest − now|²,
/// far from the goal the steps of Müller 2016 (references.bib: Muller2016Rotation). Turns that the points do not tell stay as they were.
Rotation nearest_rotation(const std::array<Vec3, kWindow>& rest, const std::array<Vec3, kWindow>& now,
                          const std::array<float, kWindow>& weight, Rotation turn) {
  constexpr int kMostIterations = 6;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    Vec3 moment, row0, row1, row2;
    float agreement = 0, size = 0;
    for (std::size_t k = 0; k < kWindow; ++k) {
      const Vec3 a = turn(rest[k]), x = now[k] * weight[k], ha = a * 0.5f, hx = x * 0.5f;
      moment += cross(a, x), agreement += dot(a, x), size += dot(a, a) * weight[k];
      row0 = row0 - ha * x.x - hx * a.x, row1 = row1 - ha * x.y - hx * a.y, row2 = row2 - ha * x.z - hx * a.z;
    }
    const float diagonal = agreement + 1e-5f * size;  // points on a line tell no twist
    const Vec3 angle = solve_positive(row0 + Vec3(diagonal, 0, 0), row1 + Vec3(0, diagonal, 0), row2 + Vec3(0, 0, diagonal),
                                      moment, moment / (std::fabs(agreement) + 1e-4f * size));
    const float turned = length(angle);
    if (!(turned > 1e-7f)) break;
    const float half = 0.5f * turned;
    turn = normalize(Rotation{std::cos(half), angle * (std::sin(half) / turned)} * turn);
    if (turned < 1e-4f) break;  // the next turn would be about its square
  }
  return turn;
}

}  // namespace

Vec3 wind_at(const SimulationSettings& s, Vec3 p, double time) {
  const float speed = length(s.wind);
  if (!(speed > 0)) return {};
  const Vec3 carried = (p - s.wind * static_cast<float>(time)) / s.gust_size;
  return s.wind + noise3_vector(carried, s.seed) * (speed * s.gusts);
}

Rod::Rod(const Vec3* rest, const SimulationSettings& settings, const DistanceGrid* grid)
    : settings_(settings), grid_(grid), rest_(rest) {
  for (std::size_t j = 0; j + 1 < kPoints; ++j) {
    const Vec3 piece = rest[j + 1] - rest[j];
    length_[j] = length(piece), rest_direction_[j] = normalize(piece);
    rigid_ = rigid_ || !(length_[j] > 1e-7f);
  }
  const float turns = 6.28318531f * settings.shape_frequency;
  for (std::size_t j = 0; j < kPoints; ++j) {
    if (j >= kFirstFree && !rigid_) inverse_mass_[j] = 2 / (length_[j - 1] + length_[j]);  // the last has half a piece
    const float left = static_cast<float>(kPoints - 1 - j) / static_cast<float>(kPoints - 1 - kFirstFree);
    pull_[j] = square(turns * square(left));
    clearance_[j] = settings.clearance;
    if (grid) clearance_[j] = std::min(clearance_[j], sample_distance(*grid, rest[j]).distance);
  }
  for (std::size_t i = 0; i < kWindows; ++i) {
    const float piece = (length_[i] + length_[i + 1] + length_[i + 2]) / 3;
    bend_[i] = rigid_ ? 0 : settings.bend_stiffness / square(square(piece));
  }
  if (!rigid_) carry_weight();
  put({});
}

// From the tip to the root: a piece that hangs carries what hangs on it, by tension. The rest of the weight is carried by what the
// hair lies on, other hair and the head: a force that turns with the head.
void Rod::carry_weight() {
  Points load{};
  for (std::size_t j = kFirstFree; j < kPoints; ++j) load[j] = settings_.gravity * (settings_.support / inverse_mass_[j]);
  for (std::size_t j = kPoints - 1; j >= kFirstFree; --j) {
    const Vec3 along = rest_direction_[j - 1];
    const float tension = std::max(0.f, dot(load[j], along));
    weight_.tension[j - 1] = tension;
    weight_.support[j] = along * tension - load[j];
    load[j - 1] += along * tension;
  }
}

void Rod::put(const Rigid& head) {
  for (std::size_t j = 0; j < kPoints; ++j) x_[j] = head(rest_[j]), v_[j] = {};
  turn_.fill(head.turn);
}

void Rod::step(const RodStep& step) {
  if (rigid_) return put(step.head);
  before_ = x_;
  predict(step);
  pull_to_shape(step);
  bend(step);
  stretch(step);
  collide(step);
  for (std::size_t j = 0; j < kPoints; ++j) v_[j] = (x_[j] - before_[j]) / step.seconds;
}

// Velocities by all that is no constraint, and where they lead.
void Rod::predict(const RodStep& step) {
  const float dt = step.seconds, kept = std::exp(-settings_.damping * dt), taken = 1 - std::exp(-settings_.drag * dt);
  Vec3 pull_of_parent;  // of the piece before, on its end
  for (std::size_t j = 1; j < kPoints; ++j) {
    Vec3 pull;
    if (j + 1 < kPoints) pull = normalize(before_[j + 1] - before_[j]) * weight_.tension[j];
    if (j >= kFirstFree) {
      const Vec3 force = pull - pull_of_parent + step.head.turn(weight_.support[j]);
      Vec3 v = v_[j] + (settings_.gravity + force * inverse_mass_[j]) * dt;
      const Vec3 of_head = (step.head(undo(step.head_before, before_[j])) - before_[j]) / dt;
      v = of_head + (v - of_head) * kept;
      v += (wind_at(settings_, before_[j], step.time) - v) * taken;
      x_[j] = before_[j] + v * dt;
    }
    pull_of_parent = pull;
  }
  for (std::size_t j = 0; j < kFirstFree; ++j) x_[j] = step.head(rest_[j]);
}

// C = x − H·p, of stiffness mω²: XPBD with compliance 1/(mω²) moves a point by −C·ω²Δt²/(1 + ω²Δt²).
void Rod::pull_to_shape(const RodStep& step) {
  for (std::size_t j = kFirstFree; j < kPoints; ++j) {
    const float share = pull_[j] * step.seconds * step.seconds;
    if (share > 0) x_[j] += (step.head(rest_[j]) - x_[j]) * (share / (1 + share));
  }
}

// Each four points that follow one another are drawn to the place where they would stand as at rest, turned and moved as a whole:
// chains of shape matching (Rungjiratananon 2010, Müller 2005; references.bib: Rungjiratananon2010Chain, Muller2005Meshless). The
// first four are those of the head.
void Rod::bend(const RodStep& step) {
  if (!(settings_.bend_stiffness > 0)) return;
  for (std::size_t i = 0; i < kWindows; ++i) {
    const float share = bend_[i] * step.seconds * step.seconds, drawn = share / (1 + share);
    if (i == 0) {
      turn_[0] = step.head.turn;
      for (std::size_t k = kFirstFree; k < kWindow; ++k) x_[k] += (step.head(rest_[k]) - x_[k]) * drawn;
      continue;
    }
    const Window rest = window(i, rest_), now = window(i, x_.data());
    turn_[i] = nearest_rotation(rest.arms, now.arms, rest.weights, turn_[i]);
    for (std::size_t k = 0; k < kWindow; ++k)
      if (inverse_mass_[i + k] > 0) x_[i + k] += (turn_[i](rest.arms[k]) - now.arms[k]) * drawn;
  }
}

Rod::Window Rod::window(std::size_t first, const Vec3* points) const {
  Window w;
  Vec3 sum;
  float total = 0;
  for (std::size_t k = 0; k < kWindow; ++k) {
    const float inverse_mass = inverse_mass_[first + k];
    w.weights[k] = inverse_mass > 0 ? 1 / inverse_mass : kPinned * length_[0];
    sum += points[first + k] * w.weights[k], total += w.weights[k];
  }
  for (std::size_t k = 0; k < kWindow; ++k) w.arms[k] = points[first + k] - sum / total;
  return w;
}

// C_i = |e_i| − l_i for all pieces at once: Newton's method, whose matrix is tridiagonal (Deul 2018; references.bib: Deul2018Rods).
void Rod::stretch(const RodStep& step) {
  constexpr int kIterations = 2;
  std::array<float, kPoints> multiplier{};
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Points along;
    std::array<float, kPoints> upper{}, right{};
    for (std::size_t i = 1; i + 1 < kPoints; ++i) {
      const Vec3 piece = x_[i + 1] - x_[i];
      const float now = length(piece);
      along[i] = now > 0 ? piece / now : step.head.turn(rest_direction_[i]);
      const float compliance = length_[i] / (settings_.stretch_stiffness * step.seconds * step.seconds);
      float diagonal = inverse_mass_[i] + inverse_mass_[i + 1] + compliance;
      float rhs = -(now - length_[i]) - compliance * multiplier[i];
      if (i > 1) {
        const float lower = -inverse_mass_[i] * dot(along[i - 1], along[i]);
        diagonal -= lower * upper[i - 1], rhs -= lower * right[i - 1];
      }
      if (i + 2 < kPoints) {
        const Vec3 next = normalize(x_[i + 2] - x_[i + 1]);
        upper[i] = -inverse_mass_[i + 1] * dot(along[i], next) / diagonal;
      }
      right[i] = rhs / diagonal;
    }
    float change = 0;
    for (std::size_t i = kPoints - 2; i >= 1; --i) {
      change = right[i] - upper[i] * change;
      multiplier[i] += change;
      x_[i + 1] += along[i] * (change * inverse_mass_[i + 1]), x_[i] += along[i] * (-change * inverse_mass_[i]);
    }
  }
}

// Out of the head, with friction; and no piece longer than it may be, whatever happened: from the root on, each point is drawn to
// the one before it and pushed out, in turn until neither has anything to do.
void Rod::collide(const RodStep& step) {
  constexpr int kMostRounds = 16;
  for (std::size_t j = kFirstFree; j < kPoints; ++j) {
    const float most = length_[j - 1] * (1 + settings_.most_stretch);
    bool moved = true;
    for (int round = 0; moved && round < kMostRounds; ++round) {
      const Vec3 piece = x_[j] - x_[j - 1];
      const float now = length(piece);
      moved = now > most * 1.001f;
      if (moved) x_[j] = x_[j - 1] + piece * (most / now);
      if (grid_) moved = push_out(step, j, round == 0 ? settings_.friction : 0) || moved;
    }
  }
}

bool Rod::push_out(const RodStep& step, std::size_t j, float friction) {
  const Vec3 local = undo(step.head, x_[j]);
  const DistanceSample skin = sample_distance(*grid_, local);
  const float depth = clearance_[j] - skin.distance;
  if (!(depth > 0)) return false;
  const Vec3 normal = normalize(skin.gradient);
  Vec3 place = local + normal * depth;
  if (friction > 0) {
    const Vec3 slide = local - undo(step.head_before, before_[j]), across = slide - normal * dot(slide, normal);
    const float way = length(across);
    if (way > 0) place = place - across * std::min(1.f, friction * depth / way);
  }
  x_[j] = step.head(place);
  return depth > 1e-5f;
}

}  // namespace pelage::groom
