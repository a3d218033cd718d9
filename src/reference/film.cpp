#include "reference/film.h"

#include <fmt/format.h>
#include <pelage/error.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"

namespace pelage {
namespace {

using Rgb = std::array<double, 3>;

constexpr std::size_t kPixelsPerTask = 4096;

void add(Rgb& sum, Vec3 v) {
  sum[0] += static_cast<double>(v.x), sum[1] += static_cast<double>(v.y), sum[2] += static_cast<double>(v.z);
}

void add_squares(Rgb& sum, Vec3 v) {
  const Rgb wide{static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
  for (std::size_t c = 0; c < 3; ++c) sum[c] += wide[c] * wide[c];
}

bool finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

double luminance(const Rgb& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

/// Variance of the mean of each channel. Squares minus squared mean may fall below 0 by rounding.
Rgb variance_of_mean(const FilmPixel& p) {
  Rgb v{};
  if (p.samples < 2) return v;
  const double n = p.samples;
  for (std::size_t c = 0; c < 3; ++c) v[c] = std::max(0.0, (p.squares[c] - p.sum[c] * p.sum[c] / n) / (n * (n - 1)));
  return v;
}

}  // namespace

Film::Film(int w, int h, bool with_bounces, bool with_lobes) : width(w), height(h) {
  pixels.resize(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
  if (with_bounces) bounces.resize(pixels.size() * kBounces);
  if (with_lobes) lobes.resize(pixels.size() * kLobes);
}

std::size_t Film::bytes() const { return pixels.size() * sizeof(FilmPixel) + (bounces.size() + lobes.size()) * sizeof(Rgb); }

std::uint32_t Film::least_samples() const {
  std::uint32_t least = std::numeric_limits<std::uint32_t>::max();
  for (const FilmPixel& p : pixels) least = std::min(least, p.samples);
  return pixels.empty() ? 0 : least;
}

void add_sample(Film& film, std::size_t at, const PathSample& s) {
  FilmPixel& p = film.pixels[at];
  if (!finite(s.radiance) || !finite(s.albedo)) {
    const auto width = static_cast<std::size_t>(film.width);
    throw Error("trace", fmt::format("pixel ({}, {}), sample {}", at % width, at / width, p.samples),
                "its radiance is not finite", "look for values that are not finite in lights, environment and textures");
  }
  add(p.sum, s.radiance);
  add_squares(p.squares, s.radiance);
  add(p.albedo, s.albedo);
  p.alpha += static_cast<double>(s.alpha);
  p.hair += s.hair ? 1.0 : 0.0;
  ++p.samples;
  if (s.depth < p.depth) {
    p.depth = s.depth;
    p.position = s.position, p.tangent = s.tangent, p.normal = s.normal;
    p.motion = s.motion, p.u = s.u;
    p.groom = s.hair ? s.groom + 1 : 0, p.strand = s.hair ? s.strand + 1 : 0;
  }
  for (std::size_t b = 0; !film.bounces.empty() && b < Film::kBounces; ++b)
    add(film.bounces[at * Film::kBounces + b], s.split->bounces[b]);
  for (std::size_t l = 0; !film.lobes.empty() && l < Film::kLobes; ++l)
    add(film.lobes[at * Film::kLobes + l], s.split->lobes[l]);
}

float picture_noise(const Film& film) {
  double variance = 0, mean = 0, seen = 0;
  for (const FilmPixel& p : film.pixels) {
    if (p.samples < 2) return std::numeric_limits<float>::infinity();
    if (p.alpha == 0) continue;
    const Rgb v = variance_of_mean(p);
    // As if the channels moved together, which those of noise do: the standard deviations add.
    const double deviation = luminance({std::sqrt(v[0]), std::sqrt(v[1]), std::sqrt(v[2])});
    variance += deviation * deviation;
    mean += luminance(p.sum) / p.samples;
    seen += 1;
  }
  return mean > 0 ? static_cast<float>(std::sqrt(variance / seen) / (mean / seen)) : 0.f;
}

namespace {

/// Channels of one layer, and how a pixel fills them.
struct Developer {
  std::vector<std::string> channels;
  void (*fill)(const Film&, std::size_t pixel, double gain, float* out);
};

void put(float* out, const Rgb& sum, double factor) {
  for (std::size_t c = 0; c < 3; ++c) out[c] = static_cast<float>(sum[c] * factor);
}

void put(float* out, Vec3 v) { out[0] = v.x, out[1] = v.y, out[2] = v.z; }

double per_sample(const FilmPixel& p) { return p.samples > 0 ? 1.0 / p.samples : 0.0; }

std::vector<std::string> xyz(const std::string& name) {
  return {fmt::format("{}.X", name), fmt::format("{}.Y", name), fmt::format("{}.Z", name)};
}
std::vector<std::string> rgb(const std::string& name) {
  return {fmt::format("{}.R", name), fmt::format("{}.G", name), fmt::format("{}.B", name)};
}

std::vector<std::string> rgb_of(const std::vector<std::string>& names) {
  std::vector<std::string> all;
  for (const std::string& name : names)
    for (const std::string& channel : rgb(name)) all.push_back(channel);
  return all;
}

std::vector<std::string> bounce_names() {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < Film::kBounces; ++b) names.push_back(fmt::format("bounce{}", b));
  return names;
}

Developer developer(TraceLayer layer) {
  switch (layer) {
    case TraceLayer::kVariance:
      return {rgb("variance"), [](const Film& f, std::size_t p, double gain, float* out) {
                put(out, variance_of_mean(f.pixels[p]), gain * gain);
              }};
    case TraceLayer::kCoverage:
      return {{"coverage"}, [](const Film& f, std::size_t p, double, float* out) {
                *out = static_cast<float>(f.pixels[p].hair * per_sample(f.pixels[p]));
              }};
    case TraceLayer::kDepth:
      return {{"Z"}, [](const Film& f, std::size_t p, double, float* out) {
                *out = std::isfinite(f.pixels[p].depth) ? f.pixels[p].depth : 0.f;
              }};
    case TraceLayer::kPosition:
      return {xyz("position"), [](const Film& f, std::size_t p, double, float* out) { put(out, f.pixels[p].position); }};
    case TraceLayer::kTangent:
      return {xyz("tangent"), [](const Film& f, std::size_t p, double, float* out) { put(out, f.pixels[p].tangent); }};
    case TraceLayer::kNormal:
      return {xyz("normal"), [](const Film& f, std::size_t p, double, float* out) { put(out, f.pixels[p].normal); }};
    case TraceLayer::kStrand:
      return {{"groom", "strand"}, [](const Film& f, std::size_t p, double, float* out) {
                out[0] = static_cast<float>(f.pixels[p].groom), out[1] = static_cast<float>(f.pixels[p].strand);
              }};
    case TraceLayer::kU: return {{"u"}, [](const Film& f, std::size_t p, double, float* out) { *out = f.pixels[p].u; }};
    case TraceLayer::kAlbedo:
      return {rgb("albedo"),
              [](const Film& f, std::size_t p, double, float* out) { put(out, f.pixels[p].albedo, per_sample(f.pixels[p])); }};
    case TraceLayer::kMotion:
      return {{"motion.X", "motion.Y"}, [](const Film& f, std::size_t p, double, float* out) {
                out[0] = f.pixels[p].motion.x, out[1] = f.pixels[p].motion.y;
              }};
    case TraceLayer::kBounces:
      return {rgb_of(bounce_names()), [](const Film& f, std::size_t p, double gain, float* out) {
                for (std::size_t b = 0; b < Film::kBounces; ++b)
                  put(out + 3 * b, f.bounces[p * Film::kBounces + b], gain * per_sample(f.pixels[p]));
              }};
    case TraceLayer::kLobes:
      return {rgb_of({"R", "TT", "TRT", "rest", "surface"}), [](const Film& f, std::size_t p, double gain, float* out) {
                for (std::size_t l = 0; l < Film::kLobes; ++l)
                  put(out + 3 * l, f.lobes[p * Film::kLobes + l], gain * per_sample(f.pixels[p]));
              }};
  }
  PELAGE_CHECK_EQ(0, 1);
  return {};
}

}  // namespace

Image develop(const Film& film, std::span<const TraceLayer> layers, const FilmBackdrop& backdrop, float exposure) {
  std::vector<std::string> names{"R", "G", "B", "A"};
  std::vector<Developer> developers;
  for (const TraceLayer layer : layers) {
    developers.push_back(developer(layer));
    names.insert(names.end(), developers.back().channels.begin(), developers.back().channels.end());
  }
  Image image(film.width, film.height, names);
  const std::size_t n = names.size();
  const double gain = std::exp2(static_cast<double>(exposure));
  parallel_for(film.pixels.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const FilmPixel& p = film.pixels[i];
      float* out = image.pixels.data() + i * n;
      const double alpha = p.alpha * per_sample(p), behind = 1 - alpha;
      const Rgb back{static_cast<double>(backdrop.color.x), static_cast<double>(backdrop.color.y),
                     static_cast<double>(backdrop.color.z)};
      for (std::size_t c = 0; c < 3; ++c) out[c] = static_cast<float>(gain * (p.sum[c] * per_sample(p) + behind * back[c]));
      out[3] = static_cast<float>(alpha + behind * static_cast<double>(backdrop.alpha));
      out += 4;
      for (const Developer& d : developers) d.fill(film, i, gain, out), out += d.channels.size();
    }
  });
  return image;
}

}  // namespace pelage
