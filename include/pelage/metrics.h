// How far a picture is from the one it should be: named metrics over the whole, over hair, over regions and over time.
// docs/metrics.md says what each metric computes and why.
#pragma once

#include <pelage/image.h>
#include <pelage/progress.h>
#include <pelage/scene.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pelage {

/// What the color values of a picture mean. The pair of pictures decides the domain in which a metric is computed.
enum class Encoding {
  kLinear,   ///< scene-linear radiance, premultiplied where alpha < 1, unbounded (EXR, Radiance HDR)
  kDisplay,  ///< sRGB-encoded 0…1, straight alpha (PNG)
};

struct Picture {
  Image image;  ///< channels R, G, B or one gray channel; A, `coverage` and `id.*` are read where they are there
  Encoding encoding = Encoding::kLinear;
  std::string name = "image";  ///< what errors call it; the file's path
};
/// EXR, PNG, Radiance HDR with the values as they stand in the file. Throws Error.
Picture read_picture(const std::string& path);
/// `picture` over an opaque background of this linear color; one without alpha stays as it is. Throws Error where it has no colors.
Picture over_background(Picture picture, Vec3 color);

struct PixelRect {
  int x = 0, y = 0, width = 0, height = 0;  ///< pixels, row 0 on top
};
struct Region {
  std::string name;
  PixelRect rect;
};
/// `columns` × `rows` tiles that cover a picture, named "x,y" from the top left. Throws Error where a tile would be empty.
std::vector<Region> tile_regions(int width, int height, int columns, int rows);

/// Hair that covers less than this share of a pixel counts as flyaway.
inline constexpr float kFlyawayCoverage = 0.3f;

/// One byte per pixel, row 0 on top, 0 leaves the pixel out. Empty: every pixel counts.
using PixelMask = std::vector<std::uint8_t>;

/// The pixels of `picture` that show hair: `coverage` above 0; without it, `id.*` not black; without that, alpha above 0
/// where alpha is not 1 all over (which also counts meshes, and `note` says so). Throws Error with a remedy where no channel
/// tells, or where none shows hair.
PixelMask hair_mask(const Picture& picture, std::string* note = nullptr);
/// The pixels of which hair covers something, but less than `most_coverage`, by channel `coverage`. Throws Error where there is
/// no such channel or pixel.
PixelMask flyaway_mask(const Picture& picture, float most_coverage = kFlyawayCoverage);
/// The pixels of which any color channel (alpha aside) is above 0. Throws Error where there are none.
PixelMask mask_from_image(const Picture& picture);

/// The pixels a value is taken over: those of `rect` that `mask` counts.
struct PixelSet {
  int width = 0;  ///< of the picture
  PixelRect rect;
  std::span<const std::uint8_t> mask = {};  ///< empty: all of `rect`

  bool contains(int x, int y) const {
    return mask.empty() || mask[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

struct CompareOptions {
  std::vector<std::string> metrics = {};  ///< keys of registered metrics; empty: all that the pair allows
  /// Set: both pictures are compared as a display shows them, scene-linear ones after this curve and sRGB encoding, as
  /// `render` writes PNG. Not set: two scene-linear pictures are compared as they are; a mixed pair as with kAces.
  std::optional<ToneMap> tone_map = {};
  PixelMask mask = {};                 ///< values are taken over these pixels; hair_mask(reference) as the papers do
  std::vector<Region> regions = {};    ///< values are also taken over each of these, within the mask
  std::vector<std::string> maps = {};  ///< keys of metrics whose errors per pixel are wanted
  /// FLIP's distance to the screen: 0.7 m from a 0.7 m wide one of 3840 pixels, 0.7 · 3840 / 0.7 · π / 180 (Andersson 2020).
  float pixels_per_degree = 67.0206433f;
  /// HDR-FLIP's first and last exposure in stops, and their number; not set: found from the reference.
  std::optional<float> start_exposure = {}, stop_exposure = {};
  int exposures = 0;  ///< 0: found
  Progress progress = {};
};

struct MetricValue {
  std::string key;              ///< e.g. "psnr"
  std::optional<double> value;  ///< none where it is infinite or where the pixels allow none; `note` says which
  std::string note = {};
};
struct RegionValues {
  std::string name;
  PixelRect rect;
  std::size_t pixels = 0;  ///< that were counted
  std::vector<MetricValue> values;
};
struct ErrorMap {
  std::string key;  ///< of its metric
  Image error;      ///< one channel `error`, 0 where the pictures agree
};
struct Comparison {
  Encoding domain = Encoding::kLinear;  ///< in which the pictures were compared
  int width = 0, height = 0;
  std::size_t pixels = 0;             ///< that were counted
  std::vector<MetricValue> values;    ///< in the order of the registry
  std::vector<MetricValue> details;   ///< what the metrics tell besides, e.g. HDR-FLIP's exposures
  std::vector<RegionValues> regions;  ///< in the order of the options
  std::vector<ErrorMap> maps;         ///< in the order of the options
  std::vector<std::string> warnings;  ///< one sentence each, for people

  /// The value of metric `key`; none where it was not computed or has none.
  std::optional<double> value(const std::string& key) const;
};

/// Compares `test` with `reference`. Throws Error on a difference of size, on NaN and infinity (naming the pixel), on an
/// unknown metric, on a metric that was asked for by name and cannot be had, and on a mask or region that does not fit. The
/// result has the same bits for any number of threads. O(pixels) for every built-in metric.
Comparison compare_images(const Picture& test, const Picture& reference, const CompareOptions& options = {});

/// Values of a sequence of frames. `frames[i]` compares frame i; the rest is over time.
struct SequenceComparison {
  std::vector<Comparison> frames;
  std::vector<MetricValue> mean;  ///< of each metric over the frames that have it
  /// PSNR of each frame against the next, of the test and of the reference: size frames − 1; none: equal.
  std::vector<std::optional<double>> adjacent_psnr, reference_adjacent_psnr;
  std::vector<double> flicker;        ///< mean |(t[i+1] − t[i]) − (r[i+1] − r[i])|, size frames − 1
  std::vector<MetricValue> temporal;  ///< adjacent_psnr, adjacent_psnr_min, …, flicker over the whole sequence
};
/// As compare_images(), frame by frame; holds two frames of each sequence in memory. `read` gives frame i of a sequence;
/// `options.maps` must be empty; `options.mask` holds for every frame, `hair` takes each frame's from its reference instead.
SequenceComparison compare_sequences(int frames, const std::function<Picture(int)>& read_test,
                                     const std::function<Picture(int)>& read_reference, bool hair = false,
                                     const CompareOptions& options = {});

/// An error per pixel painted for people: 0 … `scale` becomes the color map's ends. FLIP is magma, as in its paper, every
/// other metric viridis. R, G, B, display-encoded 0…1.
Image color_error(const ErrorMap& map, float scale);
/// The scale under which color_error() shows `map` well: 1 for metrics that end at 1, else its 99th percentile.
float color_scale(const ErrorMap& map);

// Continuity of strands: whether hair that stands alone is seen as lines or as dashes. docs/metrics.md says how and why.

/// Where a scene shows strands that stand alone: parts of strands, as places on the screen half a pixel apart.
struct FlyawayPaths {
  static constexpr float kStep = 0.5f;       ///< pixels from a place of a part to the next
  int width = 0, height = 0;                 ///< of the picture
  std::vector<Vec2> places = {};             ///< pixels, all within the picture
  std::vector<std::uint32_t> offsets = {0};  ///< [part_count + 1] where parts begin in `places`
  std::size_t part_count() const { return offsets.size() - 1; }
};
/// The parts of all strands of `scene`, in the size of its settings, that lie in pixels of which hair covers less than
/// `most_coverage` (exact area), in front of the opaque scene, and that are at least `least_length` pixels long. Strands come in
/// their order, from root to tip; the same for any number of threads. Throws Error as render() does. O(points + pixels).
FlyawayPaths flyaway_paths(const Scene& scene, float most_coverage = kFlyawayCoverage, float least_length = 8,
                           const Progress& progress = {});

struct ContinuityOptions {
  float share = 0.5f;            ///< of the reference's contrast across a strand, from which a place counts as shown; > 0
  float least_run = 8;           ///< pixels without a gap, from which a run of shown places counts as connected
  float least_contrast = 0.01f;  ///< linear; places where the reference has less contrast are not asked for
};
struct Continuity {
  std::optional<double> connected;  ///< share of the length that is shown in runs of `least_run` or more; none: no length
  std::optional<double> shown;      ///< share of the length that is shown at all
  double mean_gap = 0;              ///< pixels; 0: no gaps
  double length = 0;                ///< pixels of strand that the reference shows
};
/// How much of `paths` can be followed in `test` without a gap, by what `reference` shows of them. Alpha counts as a channel where
/// both pictures have it. Throws Error where pictures and paths differ in size, or hold NaN or infinity. O(places).
Continuity measure_continuity(const Picture& test, const Picture& reference, const FlyawayPaths& paths,
                              const ContinuityOptions& options = {});

// The registry of metrics. A metric with weights or data of its own is plugged in by register_metric(): docs/metrics.md.

/// What `evaluate` of a metric hands back: an error per pixel, and how it becomes a value over a set of pixels.
struct MetricResult {
  Image map;  ///< one channel `error`; empty where the metric has no meaning per pixel
  std::function<std::optional<double>(const PixelSet&)> value = {};  ///< not set: the mean of `map` over the set
  std::vector<MetricValue> details = {};                             ///< what else is worth telling, e.g. exposures it chose
};
/// The pair as a metric sees it: same size, finite, over black.
struct MetricInput {
  const Image& test;  ///< R, G, B in `domain`
  const Image& reference;
  Encoding domain = Encoding::kLinear;
  const std::vector<float>& test_coverage;  ///< one per pixel; empty where the picture has none
  const std::vector<float>& reference_coverage;
  const CompareOptions& options;
};
struct Metric {
  std::string key;                      ///< "flip"; a word for JSON and the command line
  std::string description;              ///< one line for people
  std::optional<Encoding> domain = {};  ///< in which it wants the pair; not set: the pair's own
  bool higher_is_better = false;
  bool has_map = true;
  std::string no_value = "no value";  ///< what to say where pixels were counted and gave none
  float map_scale = 0;                ///< the error at which its map's colors end; 0: the map decides
  /// Says why the metric cannot be had for a pair, "" where it can. Not set: it always can.
  std::function<std::string(const MetricInput&)> unavailable = {};
  std::function<MetricResult(const MetricInput&)> evaluate = {};
};
/// Every metric by registration; the built-in ones first.
const std::vector<Metric>& registered_metrics();
/// Adds `metric`, or replaces the one of the same key. Not while a comparison runs.
void register_metric(Metric metric);

}  // namespace pelage
