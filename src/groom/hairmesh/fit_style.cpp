#include "groom/hairmesh/fit_style.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "kernel/scalar.h"

namespace pelage {
namespace {

using Complex = std::complex<double>;
constexpr std::size_t kPoints = FitStrands::kPoints;
constexpr std::size_t kMostStrands = 1024;  // of a bundle that are looked at
constexpr std::uint32_t kSlowLayers = 5;    // what a spline of so few can follow is slow
constexpr double kLeastTurns = 1.5, kMostTurns = 32, kTurnStep = 0.25;
constexpr double kCurlShare =
    0.5;                       // of the quick part's energy that one frequency explains where hair is curly; of kFrizz, 0.36
constexpr double kFlat = 0.4;  // flatness from which curls are waves

/// What is left of one strand: across its base, at even w up to its tip.
struct Residual {
  Vec2 uv;
  std::size_t count = 0;                   // of points before the tip
  std::array<Complex, kPoints> fast{};     // along the normal and the binormal
  std::array<double, kSlowLayers> slow{};  // squares, by layer
  Vec3 root;
  Vec3 drift, place, along;      // at Meter::late_: slow residual, where it leads, and the base's direction
  bool late = false;             // whether the strand reaches that far
  double slow2 = 0, fast2 = 0;   // mean squares
  double turns = 0, energy = 0;  // of its strongest frequency, and mean square that this explains
  Complex right, left;           // amplitudes at the bundle's frequency, by handedness
};

Vec3 base_normal(const FitBundle& b, float w) {
  const std::size_t last = b.columns[0].size() - 2;
  const float x = w * static_cast<float>(last + 1);
  const auto k = std::min(static_cast<std::size_t>(x), last);
  const auto normal = [&](std::size_t i) {
    return normalize((b.columns[1][i] - b.columns[0][i]) + (b.columns[2][i] - b.columns[3][i]));
  };
  return lerp(normal(k), normal(k + 1), std::min(x - static_cast<float>(k), 1.f));
}

/// The frame in which operators shift a strand (strand_group-inl.h).
struct Frame {
  Vec3 normal, binormal;
};
Frame base_frame(const FitBundle& b, const LayerSpline& spline, const std::vector<Vec3>& base, float w) {
  const Vec3 along = normalize(spline.derivative(base.data(), w)), side = base_normal(b, w);
  const Vec3 normal = normalize(side - along * dot(side, along));
  return {normal, cross(along, normal)};
}

/// The frequencies that are looked for.
constexpr std::size_t kWaves = static_cast<std::size_t>((kMostTurns - kLeastTurns) / kTurnStep) + 1;
double turns_of(std::size_t i) { return kLeastTurns + kTurnStep * static_cast<double>(i); }
std::size_t wave_of(double turns) {
  return static_cast<std::size_t>(std::lround((std::max(turns, kLeastTurns) - kLeastTurns) / kTurnStep));
}

/// Cosines and sines of all frequencies, point by point: sums over the points of all frequencies at once run in lanes.
struct WaveTable {
  std::vector<std::array<float, kWaves>> cosine, sine;  // [kPoints]
};
const WaveTable& waves() {
  static const WaveTable table = [] {
    WaveTable t;
    t.cosine.resize(kPoints), t.sine.resize(kPoints);
    for (std::size_t i = 0; i < kPoints; ++i)
      for (std::size_t f = 0; f < kWaves; ++f) {
        const double angle = 2 * std::numbers::pi * turns_of(f) * static_cast<double>(i) / (kPoints - 1);
        t.cosine[i][f] = static_cast<float>(std::cos(angle)), t.sine[i][f] = static_cast<float>(std::sin(angle));
      }
    return t;
  }();
  return table;
}

/// Hann's, over the points before the tip: keeps slow drifts out.
double window(const Residual& r, std::size_t i) {
  return 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(r.count));
}

/// Squared amplitudes of all frequencies, both ways of turning.
std::array<float, kWaves> spectrum_of(const Residual& r) {
  std::array<float, kWaves> xc{}, xs{}, yc{}, ys{}, energy;
  double total = 0;
  for (std::size_t i = 0; i < r.count; ++i) {
    const double w = window(r, i);
    const auto x = static_cast<float>(w * r.fast[i].real()), y = static_cast<float>(w * r.fast[i].imag());
    const auto &c = waves().cosine[i], &s = waves().sine[i];
    for (std::size_t f = 0; f < kWaves; ++f) xc[f] += x * c[f], xs[f] += x * s[f], yc[f] += y * c[f], ys[f] += y * s[f];
    total += w;
  }
  // |right|² + |left|² of amplitudes().
  const auto scale = static_cast<float>(2 / (total * total));
  for (std::size_t f = 0; f < kWaves; ++f) energy[f] = scale * (xc[f] * xc[f] + xs[f] * xs[f] + yc[f] * yc[f] + ys[f] * ys[f]);
  return energy;
}

/// Amplitudes of a turning to the right and of one to the left, Σ weight·z·e^∓iωw over the sum of weights; returns that.
template <class Weight>
double amplitudes(const Residual& r, std::size_t wave, const Weight& weight, Complex& right, Complex& left) {
  double total = 0, a = 0, b = 0, c = 0, d = 0;
  for (std::size_t i = 0; i < r.count; ++i) {
    const double w = weight(i), x = w * r.fast[i].real(), y = w * r.fast[i].imag();
    const auto cosine = static_cast<double>(waves().cosine[i][wave]), sine = static_cast<double>(waves().sine[i][wave]);
    a += x * cosine, b += x * sine, c += y * cosine, d += y * sine, total += w;
  }
  right = {a + d, c - b}, left = {a - d, c + b};
  if (total > 0) right /= total, left /= total;
  return total;
}

class Meter {
 public:
  Meter(const FitStrands& f, const FitBundle& b)
      : f_(f), b_(b), spline_(static_cast<std::uint32_t>(b.columns[0].size()), kPoints), slow_(kSlowLayers, kPoints),
        late_(static_cast<float>(0.95 * std::max(0.4, 1 - b.length_spread))) {
    const std::size_t n = b.strands.size(), count = std::min(n, kMostStrands);
    for (std::size_t i = 0; i < count; ++i) take_strand(i * n / count);
    find_neighbors();
  }

  StrandHabits measure() {
    h_.strands = static_cast<double>(b_.strands.size());
    h_.slow2 = mean([](const Residual& r) { return r.slow2; }), h_.fast2 = mean([](const Residual& r) { return r.fast2; });
    h_.length_variation = b_.length_spread;
    measure_slow();
    measure_fast();
    measure_widths();
    return h_;
  }

 private:
  template <class F>
  double mean(const F& of) const {
    double sum = 0;
    for (const Residual& r : r_) sum += of(r);
    return r_.empty() ? 0 : sum / static_cast<double>(r_.size());
  }

  void take_strand(std::size_t i) {
    const std::uint32_t s = b_.strands[i];
    const float tip = std::min(b_.tip[i], 1.f);
    Residual r;
    r.uv = b_.uv[i];
    base_vertices(b_, r.uv, base_);
    std::array<Vec3, kPoints> off;
    for (std::size_t k = 0; k < kPoints; ++k) {
      const float w = static_cast<float>(k) / static_cast<float>(kPoints - 1);
      if (w > tip && k > 0) {
        off[k] = off[k - 1];
        continue;
      }
      off[k] = f_.at(s, w / b_.tip[i]) - spline_.at(base_.data(), w);
      r.count = k + 1;
    }
    std::array<Vec3, kSlowLayers> slow;
    slow_.project(off.data(), slow.data());
    for (std::size_t k = 0; k < r.count; ++k) {
      const float w = static_cast<float>(k) / static_cast<float>(kPoints - 1);
      const Vec3 smooth = slow_.at(slow.data(), w), quick = off[k] - smooth;
      const Frame frame = base_frame(b_, spline_, base_, w);
      r.fast[k] = {static_cast<double>(dot(quick, frame.normal)), static_cast<double>(dot(quick, frame.binormal))};
      r.slow2 += static_cast<double>(dot(smooth, smooth)) / static_cast<double>(r.count);
      r.fast2 += std::norm(r.fast[k]) / static_cast<double>(r.count);
    }
    for (std::size_t k = 0; k < kSlowLayers; ++k) r.slow[k] = static_cast<double>(dot(slow[k], slow[k]));
    r.root = f_.strand(s)[0];
    r.drift = slow_.at(slow.data(), late_), r.place = spline_.at(base_.data(), late_) + r.drift;
    r.along = normalize(spline_.derivative(base_.data(), late_)), r.late = tip >= late_;
    r_.push_back(r);
  }

  void find_neighbors() {
    neighbor_.resize(r_.size());
    for (std::size_t i = 0; i < r_.size(); ++i) {
      float least = 1e30f;
      for (std::size_t j = 0; j < r_.size(); ++j) {
        const Vec3 d = r_[j].root - r_[i].root;
        if (j != i && dot(d, d) < least) least = dot(d, d), neighbor_[i] = j;
      }
    }
  }

  /// Area of a rectangle that is spread as points are across the direction in which they are spread least.
  template <class Place>
  static double area_of(const std::vector<const Residual*>& some, const Place& place) {
    Vec3 mean;
    for (const Residual* r : some) mean += place(*r) * (1.f / static_cast<float>(some.size()));
    double c[3][3] = {};
    for (const Residual* r : some) {
      const Vec3 d = place(*r) - mean;
      const double x[3] = {static_cast<double>(d.x), static_cast<double>(d.y), static_cast<double>(d.z)};
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) c[i][j] += x[i] * x[j] / static_cast<double>(some.size());
    }
    const double minors =
        c[0][0] * c[1][1] - c[0][1] * c[1][0] + c[0][0] * c[2][2] - c[0][2] * c[2][0] + c[1][1] * c[2][2] - c[1][2] * c[2][1];
    return 12 * std::sqrt(std::max(0., minors));
  }

  /// Mean distance of each to the nearest one.
  template <class Place>
  static double nearest_distance(const std::vector<const Residual*>& some, const Place& place) {
    double sum = 0;
    for (const Residual* a : some) {
      float least = 1e30f;
      for (const Residual* b : some) {
        const Vec3 d = place(*a) - place(*b);
        if (a != b) least = std::min(least, dot(d, d));
      }
      sum += std::sqrt(static_cast<double>(least));
    }
    return sum / static_cast<double>(some.size());
  }

  /// Distance of roots at which strands drift alike by 0.35 only; `limit` where they do farther away than that.
  static double drift_distance(const std::vector<const Residual*>& some, double limit) {
    constexpr std::size_t kBins = 32;
    std::array<double, kBins> product{}, count{};
    double square = 0;
    for (std::size_t i = 0; i < some.size(); ++i) {
      square += static_cast<double>(dot(some[i]->drift, some[i]->drift)) / static_cast<double>(some.size());
      for (std::size_t j = i + 1; j < some.size(); ++j) {
        const double bin = static_cast<double>(length(some[i]->root - some[j]->root)) / limit * kBins;
        if (!(bin < kBins)) continue;
        product[static_cast<std::size_t>(bin)] += static_cast<double>(dot(some[i]->drift, some[j]->drift));
        ++count[static_cast<std::size_t>(bin)];
      }
    }
    for (std::size_t b = 0; b < kBins; ++b)
      if (count[b] > 0 && product[b] / count[b] < 0.35 * square) return limit * (static_cast<double>(b) + 0.5) / kBins;
    return limit;
  }

  /// Strands of a clump come nearer to each other, late along them, than their roots are, and drift alike: across 0.25
  /// of a clump that draws strands to its middle, across 0.6 of one that drifts as a whole; 0.35 is between. What clumps do
  /// not explain is drift.
  void measure_slow() {
    std::vector<const Residual*> late;
    Vec3 along;
    for (const Residual& r : r_)
      if (r.late) late.push_back(&r), along += r.along;
    if (late.size() < 8) return;
    along = normalize(along);
    const auto across = [&](Vec3 p) { return p - along * dot(p, along); };
    const auto root = [](const Residual& r) { return r.root; };
    const auto place = [&](const Residual& r) { return across(r.place); };
    const double side = std::sqrt(area_of(late, root)), late_side = std::sqrt(area_of(late, place));
    if (!(side > 0)) return;
    const double even = nearest_distance(late, root) / side * late_side;  // where all strands went apart alike
    const double gathered = even > 0 ? std::clamp(1 - nearest_distance(late, place) / even, 0., 0.95) : 0;
    h_.clumps = std::clamp(0.35 * side / drift_distance(late, side), 1., 32.);
    h_.clump_start = clump_start();
    const auto growth = static_cast<double>(kernel::style_growth(late_, static_cast<float>(h_.clump_start)));
    h_.clump = gathered > 0.05 ? std::min(0.95, gathered / std::max(growth, 0.1)) : 0;
    measure_drift();
  }

  /// A strand of a square cell lies 0.323 cells from a middle that is off by up to a quarter, on either axis (root mean square).
  void measure_drift() {
    const double drift2 = mean([](const Residual& r) { return static_cast<double>(dot(r.drift, r.drift)); });
    if (!(drift2 > 0)) return;
    const Vec3 u = (b_.columns[1].back() - b_.columns[0].back() + b_.columns[2].back() - b_.columns[3].back()) * 0.5f;
    const Vec3 v = (b_.columns[3].back() - b_.columns[0].back() + b_.columns[2].back() - b_.columns[1].back()) * 0.5f;
    const double clumped2 = std::pow(0.323 * h_.clump / h_.clumps, 2) * static_cast<double>(dot(u, u) + dot(v, v));
    h_.drift = std::sqrt(std::max(0., 1 - clumped2 / drift2) * h_.slow2);
    h_.drift_variation = spread_of_turns(
        [](const Residual& a, const Residual& b) { return static_cast<double>(dot(normalize(a.drift), normalize(b.drift))); });
  }

  /// The x over which phases spread evenly, by how neighbors agree: cosine(strand, strand). Half of them differ by less than
  /// (1 − √½)·x turns. The median, for the nearest root may belong to another lock.
  template <class Cosine>
  double spread_of_turns(const Cosine& cosine) const {
    std::vector<double> turns;
    for (std::size_t i = 0; i < r_.size(); ++i)
      turns.push_back(std::acos(std::clamp(cosine(r_[i], r_[neighbor_[i]]), -1., 1.)) / (2 * std::numbers::pi));
    if (turns.empty()) return 0;
    const auto middle = turns.begin() + static_cast<std::ptrdiff_t>(turns.size() / 2);
    std::nth_element(turns.begin(), middle, turns.end());
    return std::min(1., *middle / (1 - std::sqrt(0.5)));
  }

  /// The start whose growth is nearest to that of the residual, layer by layer.
  double clump_start() const {
    std::array<double, kSlowLayers> size{};
    for (std::size_t k = 0; k < kSlowLayers; ++k) size[k] = std::sqrt(mean([&](const Residual& r) { return r.slow[k]; }));
    double best = 0, most = -1;
    for (int i = 0; i <= 6; ++i) {
      const float start = 0.1f * static_cast<float>(i);
      double product = 0, square = 0;
      for (std::size_t k = 0; k < kSlowLayers; ++k) {
        const auto growth = static_cast<double>(kernel::style_growth(static_cast<float>(k) / (kSlowLayers - 1), start));
        product += growth * size[k], square += growth * growth;
      }
      const double explained = product * product / square;
      if (explained > most) most = explained, best = static_cast<double>(start);
    }
    return best;
  }

  /// The frequency that explains most of the quick part makes curls or waves, the rest is frizz.
  void measure_fast() {
    if (!(h_.fast2 > 0)) return;
    std::vector<double> spectrum(kWaves);
    for (Residual& r : r_) {
      if (r.count < 16) continue;
      const std::array<float, kWaves> energy = spectrum_of(r);
      for (std::size_t f = 0; f < kWaves; ++f) spectrum[f] += static_cast<double>(energy[f]);
      const auto most = static_cast<std::size_t>(std::max_element(energy.begin(), energy.end()) - energy.begin());
      r.energy = static_cast<double>(energy[most]), r.turns = turns_of(most);
    }
    const auto peak = static_cast<std::size_t>(std::max_element(spectrum.begin(), spectrum.end()) - spectrum.begin());
    double frizz2 = h_.fast2;
    if (mean([](const Residual& r) { return r.energy; }) > kCurlShare * windowed_energy())
      frizz2 = measure_curl(peak, spectrum);
    measure_frizz(spectrum, frizz2);
  }

  /// Mean square of the quick part as the window of amplitudes() weighs it.
  double windowed_energy() const {
    return mean([](const Residual& r) {
      double sum = 0, total = 0;
      for (std::size_t i = 0; i < r.count; ++i) sum += window(r, i) * std::norm(r.fast[i]), total += window(r, i);
      return total > 0 ? sum / total : 0;
    });
  }

  /// Frequencies within a factor of 1.8 of the mean one are taken for curls. Returns the mean square of the others.
  double measure_curl(std::size_t bundle_wave, const std::vector<double>& spectrum) {
    double more = 0, less = 0, weight = 0, turns = 0;
    for (Residual& r : r_) {
      amplitudes(
          r, wave_of(r.turns), [&](std::size_t i) { return window(r, i); }, r.right, r.left);
      const double a = std::norm(r.right), b = std::norm(r.left);
      more += std::max(a, b), less += std::min(a, b), turns += r.energy * r.turns, weight += r.energy;
    }
    h_.frequency = turns / weight, h_.flatness = less / more;
    double band = 0, all = 0;
    for (std::size_t f = 0; f < kWaves; ++f) {
      const double ratio = turns_of(f) / h_.frequency;
      all += spectrum[f], band += ratio > 1 / 1.8 && ratio < 1.8 ? spectrum[f] : 0;
    }
    const double start = find_start(), share = band / all;
    double onset2 = 0;  // its mean along the strand
    for (std::size_t i = 0; i < kPoints; ++i)
      onset2 +=
          std::pow(static_cast<double>(kernel::style_onset(static_cast<float>(i) / (kPoints - 1), static_cast<float>(start))),
                   2) /
          static_cast<double>(kPoints);
    h_.curl_start = start;
    // A wave of amplitude a has half the mean square of a helix of that radius.
    h_.curl = std::sqrt((h_.flatness > kFlat ? 2. : 1.) * share * h_.fast2 / onset2);
    h_.curl_variation = spread_of_phases(bundle_wave);
    return (1 - share) * h_.fast2;
  }

  /// Energy of a strand that turnings of its own frequency explain when they set in at `start`, and Σ onset².
  std::pair<double, double> explained_by_curl(const Residual& r, double start) const {
    const auto onset = [&](std::size_t i) {
      return static_cast<double>(
          kernel::style_onset(static_cast<float>(i) / static_cast<float>(kPoints - 1), static_cast<float>(start)));
    };
    Complex right, left;
    const double total = amplitudes(r, wave_of(r.turns), onset, right, left);
    double square = 0;
    for (std::size_t i = 0; i < r.count; ++i) square += onset(i) * onset(i);
    return {square > 0 ? total * total * (std::norm(right) + std::norm(left)) / square : 0, square};
  }

  double find_start() const {
    double best = 0, most = -1;
    for (int i = 0; i <= 10; ++i) {
      const double start = 0.05 * i, explained = mean([&](const Residual&r) { return explained_by_curl(r, start).first; });
      if (explained > most) most = explained, best = start;
    }
    return best;
  }

  double spread_of_phases(std::size_t bundle_wave) {
    for (Residual& r : r_)
      amplitudes(
          r, bundle_wave, [&](std::size_t i) { return window(r, i); }, r.right, r.left);
    return spread_of_turns([&](const Residual& a, const Residual& b) {
      const double size = std::sqrt((std::norm(a.right) + std::norm(a.left)) * (std::norm(b.right) + std::norm(b.left)));
      return size > 0 ? (a.right * std::conj(b.right) + a.left * std::conj(b.left)).real() / size : 0;
    });
  }

  /// style_frizz() has half of its amount as root mean square; strands have 1 − variation·√(even) of that, of which the mean
  /// and the mean square are known.
  void measure_frizz(const std::vector<double>& spectrum, double frizz2) {
    double energy = 0, turns = 0;
    for (std::size_t i = 0; i < spectrum.size(); ++i) energy += spectrum[i], turns += spectrum[i] * turns_of(i);
    if (!(energy > 0) || !(frizz2 > 0)) return;
    const double size = mean([](const Residual& r) { return std::sqrt(r.fast2); });
    const double evenness = std::clamp(size * size / h_.fast2, 0., 1.);
    double nearest = 2;
    for (int i = 0; i <= 20; ++i) {
      const double v = 0.05 * i, of_mean = 1 - 2 * v / 3, of_square = 1 - 4 * v / 3 + v * v / 2;
      if (const double off = std::fabs(of_mean * of_mean / of_square - evenness); off < nearest) {
        nearest = off;
        h_.frizz_variation = v, h_.frizz = 2 * std::sqrt(frizz2 / of_square);
      }
    }
    h_.frizz_frequency = turns / energy;
  }

  void measure_widths() {
    std::array<double, FitStrands::kWidths> profile{};
    double shares = 0, squares = 0, count = 0;
    for (const std::uint32_t s : b_.strands) {
      const float* w = &f_.widths[s * FitStrands::kWidths];
      if (!(w[0] > 0)) continue;
      for (std::size_t k = 0; k < profile.size(); ++k) profile[k] += static_cast<double>(w[k] / w[0]);
      const double tip = std::min(1., static_cast<double>(w[FitStrands::kWidths - 1] / w[0]));
      shares += tip, squares += tip * tip, ++count;
    }
    if (!(count > 0)) return;
    const double tip = shares / count, deviation = std::sqrt(std::max(0., squares / count - tip * tip));
    h_.tip_width = std::min({1., tip + std::sqrt(3.) * deviation, 2 * tip});
    h_.tip_variation = h_.tip_width > 0 ? std::clamp(2 * (1 - tip / h_.tip_width), 0., 1.) : 0;
    double least = 1e9;
    for (int i = 0; i <= 9; ++i) {
      const float start = 0.1f * static_cast<float>(i);
      double error = 0;
      for (std::size_t k = 0; k < profile.size(); ++k) {
        const float w = static_cast<float>(k) / static_cast<float>(FitStrands::kWidths - 1);
        const double d = static_cast<double>(kernel::style_taper(w, start, static_cast<float>(tip))) - profile[k] / count;
        error += d * d;
      }
      if (error < least) least = error, h_.taper_start = static_cast<double>(start);
    }
  }

  const FitStrands& f_;
  const FitBundle& b_;
  LayerSpline spline_, slow_;
  float late_;  // w that nearly all strands reach
  std::vector<Residual> r_;
  std::vector<std::size_t> neighbor_;  // of each residual: the nearest root
  std::vector<Vec3> base_;
  StrandHabits h_;
};

}  // namespace

StrandHabits measure_habits(const FitStrands& strands, const FitBundle& bundle) { return Meter(strands, bundle).measure(); }

StrandHabits mean_habits(const std::vector<StrandHabits>& habits) {
  using Field = double StrandHabits::*;
  StrandHabits m;
  const auto take = [&](const std::vector<Field>& fields, const auto& weight) {
    double total = 0;
    for (const StrandHabits& h : habits) total += weight(h);
    for (const Field field : fields) {
      double sum = 0;
      for (const StrandHabits& h : habits) sum += weight(h) * h.*field;
      if (total > 0) m.*field = sum / total;
    }
  };
  using H = StrandHabits;
  take({&H::slow2, &H::fast2, &H::clump, &H::curl, &H::frizz, &H::drift, &H::length_variation, &H::tip_width, &H::tip_variation,
        &H::taper_start, &H::clumps, &H::clump_start},
       [](const H& h) { return h.strands; });
  take({&H::frequency, &H::flatness, &H::curl_start, &H::curl_variation},
       [](const H& h) { return h.strands * h.curl * h.curl; });
  take({&H::frizz_frequency, &H::frizz_variation}, [](const H& h) { return h.strands * h.frizz * h.frizz; });
  take({&H::drift_variation}, [](const H& h) { return h.strands * h.drift * h.drift; });
  for (const StrandHabits& h : habits) m.strands += h.strands;
  return m;
}

std::vector<StyleOperator> operators_of(const StrandHabits& h, float width) {
  using Kind = StyleOperator::Kind;
  std::vector<StyleOperator> list;
  const auto add = [&](Kind kind, double amount, double frequency, double start, double variation) {
    list.push_back({kind, static_cast<float>(amount), static_cast<float>(frequency),
                    static_cast<float>(std::clamp(start, 0., 1.)), static_cast<float>(std::clamp(variation, 0., 1.))});
  };
  constexpr double kMost = 0.1;  // metres, of any shift
  const double least = 0.25 * static_cast<double>(width);
  if (h.length_variation > 0.005) add(Kind::kLength, 1, 0, 0, h.length_variation);
  // Curls and drifts go lock by lock where clumps say what a lock is, be they ever so loose.
  const double clumps = std::clamp(std::round(h.clumps), 1., 32.);
  const bool curls = h.curl > least, flat = h.flatness > kFlat, locks = clumps > 1, drifts = h.drift > least;
  if (h.clump > 0.05 || (locks && (curls || drifts))) add(Kind::kClump, h.clump, clumps, h.clump_start, 0);
  if (curls) add(flat ? Kind::kWave : Kind::kCurl, std::min(h.curl, kMost), h.frequency, h.curl_start, h.curl_variation);
  // Half a wave or so to one side, or where waves are taken, or locks are not known, noise: 1/√3 of its amount on the average.
  const bool swings = drifts && locks && !(curls && flat);
  if (swings) add(Kind::kWave, std::min(std::sqrt(2.) * h.drift, kMost), 0.75, 0, h.drift_variation);
  else if (drifts) add(Kind::kNoise, std::min(std::sqrt(3.) * h.drift, kMost), 2, 0, std::max(0.5, h.drift_variation));
  if (h.frizz > least) add(Kind::kFrizz, std::min(h.frizz, kMost), h.frizz_frequency, 0, h.frizz_variation);
  if (h.tip_width < 0.99) add(Kind::kTaper, h.tip_width, 0, h.taper_start, h.tip_variation);
  return list;
}

}  // namespace pelage
