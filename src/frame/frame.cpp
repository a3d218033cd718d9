// One frame: the list of stages, in the order of the diagram (HACKING.md).
#include <algorithm>
#include <span>
#include <utility>

#include "assemble/assemble.h"
#include "composite/composite.h"
#include "composite/debug_view.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "frame/one_frame.h"
#include "frame/ways_back.h"
#include "frame/window.h"
#include "raster/opaque.h"
#include "raster/keys.h"
#include "raster/raster.h"
#include "shade/shade.h"

namespace pelage {
namespace {

template <class... T>
std::uint64_t bytes_of(const Buffer<T>&... buffers) {
  return (std::uint64_t{0} + ... + buffers.bytes());
}

std::uint64_t bytes_of(const GBuffer& g) {
  // Without opaque_depth, which the opaque layer counts.
  return bytes_of(g.center, g.conservative, g.sample_keys, g.coverage, g.tangent_cos2, g.tangent_sin2, g.overdraw);
}

constexpr Vec2 kPixelCenter{0.5f, 0.5f};

// Sample layers of a large picture would not fit into memory: bands of about this many samples do. The bands follow from
// the scene alone, never from the machine, because a band's pixels may differ in the last bit from a whole picture's.
constexpr std::size_t kSamplesPerBand = std::size_t{1} << 23;

/// Rows of `window` that go through raster, shade and resolve together; none of an empty one.
std::vector<Window> bands_of(const Window& window, std::size_t samples) {
  std::vector<Window> bands;
  if (window.width <= 0 || window.height <= 0) return bands;
  const std::size_t per_row = static_cast<std::size_t>(window.width) * samples;
  const int most = static_cast<int>(std::max<std::size_t>(1, kSamplesPerBand / per_row));
  const int count = (window.height + most - 1) / most, rows = (window.height + count - 1) / count;
  for (int y = 0; y < window.height; y += rows)
    bands.push_back({window.x, window.y + y, window.width, std::min(rows, window.height - y)});
  return bands;
}

// The strand that touches each pixel none of whose samples a strand covers: colors for AlphaSource::kAnalytic.
GBuffer edge_layer(const GBuffer& gbuffer) {
  GBuffer edges;
  edges.width = gbuffer.width;
  edges.height = gbuffer.height;
  edges.center.resize(gbuffer.conservative.size());
  const auto samples = static_cast<std::size_t>(gbuffer.samples);
  for (std::size_t p = 0; p < edges.center.size(); ++p) {
    const PixelKey* keys = gbuffer.sample_keys.data() + p * samples;
    const bool covered = std::any_of(keys, keys + samples, [](PixelKey key) { return key != kEmptyPixel; });
    edges.center[p] = covered ? kEmptyPixel : gbuffer.conservative[p];
  }
  return edges;
}

// Nearest thing that the first sample of each pixel sees, strand or mesh.
void keep_nearest(const GBuffer& gbuffer, const Window& band, int picture_width, Buffer<float>& nearest) {
  const Buffer<PixelKey>& keys = gbuffer.sample_keys.empty() ? gbuffer.center : gbuffer.sample_keys;
  const auto samples = static_cast<std::size_t>(gbuffer.samples), width = static_cast<std::size_t>(band.width);
  parallel_for(static_cast<std::size_t>(band.height), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin * width; p < end * width; ++p) {
      const PixelKey key = keys[p * samples];
      const float mesh = gbuffer.opaque_depth.empty() ? INFINITY : gbuffer.opaque_depth[p * samples];
      const std::size_t row = static_cast<std::size_t>(band.y) + p / width,
                        column = static_cast<std::size_t>(band.x) + p % width;
      nearest[row * static_cast<std::size_t>(picture_width) + column] = key == kEmptyPixel ? mesh : key_depth(key);
    }
  });
}

void render_band(const FrameInputs& inputs, const Window& band, std::span<const Vec2> samples, Stages& stages, Image& linear,
                 Buffer<float>* nearest) {
  const RenderSettings& settings = inputs.scene.settings;
  const CameraView view = view_of(inputs.view, band);
  const bool analytic = settings.alpha == AlphaSource::kAnalytic;
  const std::uint64_t pixels = static_cast<std::uint64_t>(view.width) * static_cast<std::uint64_t>(view.height);

  OpaqueLayer opaque;
  if (!inputs.meshes.empty())
    stages.run("opaque", "samples", [&](const Progress&) {
      opaque = trace_opaque(inputs.scene, view, samples, inputs.meshes, inputs.rig);
      return StageWork{pixels * samples.size(),
                       bytes_of(opaque.depth, opaque.color) + bytes_of(opaque.first) + bytes_of(opaque.shade)};
    });

  GBuffer gbuffer;
  stages.run("raster", "segments", [&](const Progress& progress) {
    RasterLayers layers{
        .center = false, .conservative = analytic, .samples = static_cast<int>(samples.size()), .analytic = analytic};
    if (samples.size() == 1 && samples[0] == kPixelCenter && !analytic) layers.center = true, layers.samples = 0;
    gbuffer.opaque_depth = std::move(opaque.depth);
    const std::uint64_t segments = raster_strands(inputs.scene, view, inputs.numbering, layers, gbuffer, progress);
    return StageWork{segments, bytes_of(gbuffer)};
  });

  if (nearest) keep_nearest(gbuffer, band, settings.width, *nearest);
  gbuffer.opaque_depth.release();  // what it hides is gone

  Radiance radiance, edges;
  stages.run("shade", "evaluations", [&](const Progress&) {
    radiance = shade(inputs.scene, view, inputs.numbering, gbuffer, inputs.rig, samples);
    if (analytic)
      edges = shade(inputs.scene, view, inputs.numbering, edge_layer(gbuffer), inputs.rig, std::array{kPixelCenter});
    return StageWork{radiance.color.size() + edges.color.size(),
                     bytes_of(radiance.index, edges.index) + bytes_of(radiance.color, edges.color)};
  });

  gbuffer.sample_keys.release();  // every strand that they show has its color
  stages.run("composite", "pixels", [&](const Progress&) {
    if (linear.pixels.empty()) linear = Image(settings.width, settings.height, {"R", "G", "B", "A"});
    resolve({gbuffer, radiance, edges, opaque, make_backdrop(inputs.scene, view)}, settings, band.x, band.y, linear);
    return StageWork{pixels, linear.pixels.size() * sizeof(float)};
  });
}

}  // namespace

Image render_frame(const FrameInputs& inputs, std::span<const Vec2> positions, Stages& stages, Buffer<float>* nearest) {
  const RenderSettings& settings = inputs.scene.settings;
  const auto pixels = static_cast<std::size_t>(settings.width) * static_cast<std::size_t>(settings.height);
  const Window window = window_of(inputs.view, inputs.rig.strands, inputs.meshes);
  const bool beside = window.width < settings.width || window.height < settings.height;
  if (nearest) nearest->resize(pixels);
  if (nearest && beside) nearest->fill(INFINITY);
  Image linear;  // made by the first band that is ready for it, where they make all of it
  if (beside)
    stages.run("composite", "pixels", [&](const Progress&) {
      linear = backdrop_picture(make_backdrop(inputs.scene, inputs.view), settings);
      return StageWork{pixels - static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height),
                       linear.pixels.size() * sizeof(float)};
    });
  const std::vector<Window> bands = bands_of(window, positions.size());
  for (std::size_t i = 0; i < bands.size(); ++i) {
    stages.set_band(static_cast<int>(i), static_cast<int>(bands.size()));
    render_band(inputs, bands[i], positions, stages, linear, nearest);
  }
  stages.set_band(0, 1);
  return linear;
}

Buffer<float> render_nearest(const FrameInputs& inputs, Stages& stages, Buffer<Vec3>* way) {
  GBuffer gbuffer;
  gbuffer.opaque_depth = trace_opaque(inputs.scene, inputs.view, std::array{kPixelCenter}, inputs.meshes, inputs.rig).depth;
  stages.run("raster", "segments", [&](const Progress& progress) {
    const std::uint64_t segments = raster_strands(inputs.scene, inputs.view, inputs.numbering, {}, gbuffer, progress);
    return StageWork{segments, bytes_of(gbuffer)};
  });
  Buffer<float> nearest(gbuffer.center.size());
  keep_nearest(gbuffer, {0, 0, inputs.view.width, inputs.view.height}, inputs.view.width, nearest);
  if (way && inputs.before) *way = ways_back(inputs, gbuffer.center, nearest);
  return nearest;
}

DebugView render_debug_view(const FrameInputs& inputs, View what, Stages& stages) {
  GBuffer gbuffer;
  gbuffer.opaque_depth = trace_opaque(inputs.scene, inputs.view, std::array{kPixelCenter}, inputs.meshes, inputs.rig).depth;
  stages.run("raster", "segments", [&](const Progress& progress) {
    const RasterLayers layers{.analytic = what == View::kCoverage, .overdraw = what == View::kOverdraw};
    const std::uint64_t segments = raster_strands(inputs.scene, inputs.view, inputs.numbering, layers, gbuffer, progress);
    return StageWork{segments, bytes_of(gbuffer)};
  });
  DebugView view;
  stages.run("composite", "pixels", [&](const Progress&) {
    view = make_debug_view(inputs.scene, inputs.view, inputs.numbering, gbuffer, what);
    return StageWork{gbuffer.center.size(), (view.data.pixels.size() + view.display.pixels.size()) * sizeof(float)};
  });
  return view;
}

}  // namespace pelage
