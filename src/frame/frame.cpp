// One frame: the list of stages, in the order of the diagram (HACKING.md).
#include <pelage/error.h>
#include <pelage/render.h>

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "assemble/assemble.h"
#include "composite/composite.h"
#include "composite/debug_view.h"
#include "core/mesh_tracer.h"
#include "frame/camera_view.h"
#include "frame/frame.h"
#include "frame/stages.h"
#include "light/light.h"
#include "raster/opaque.h"
#include "raster/raster.h"
#include "raster/sample_positions.h"
#include "shade/shade.h"

namespace pelage {
namespace {

void check_settings(const RenderSettings& s) {
  const auto require = [](bool sound, const char* name, auto value, const char* range) {
    if (!sound) throw Error("settings", name, fmt::format("{} is out of range", value), range);
  };
  require(s.width >= 1 && s.width <= 16384, "width", s.width, "1…16384");
  require(s.height >= 1 && s.height <= 16384, "height", s.height, "1…16384");
  require(is_sample_count(s.samples), "samples", s.samples, "1, 2, 4, 8 or 16");
  require(s.subdivisions >= 0 && s.subdivisions <= 64, "subdivisions", s.subdivisions, "0…64");
  require(s.opacity_map_size >= 64 && s.opacity_map_size <= 4096, "opacity_map_size", s.opacity_map_size, "64…4096");
  require(s.exposure >= -100 && s.exposure <= 100, "exposure", s.exposure, "-100…100");
}

StageWork groom_work(const Scene& scene) {
  StageWork work;
  for (const GroomInstance& groom : scene.grooms) {
    if (!groom.strands) throw Error("scene", groom.name, "a groom without strands", "set GroomInstance::strands");
    work.items += groom.strands->point_count();
    work.bytes += resident_bytes(*groom.strands);
  }
  return work;
}

template <class... T>
std::uint64_t bytes_of(const Buffer<T>&... buffers) {
  return (std::uint64_t{0} + ... + buffers.bytes());
}

std::uint64_t bytes_of(const GBuffer& g) {
  return bytes_of(g.center, g.conservative, g.sample_keys, g.coverage, g.tangent_cos2, g.tangent_sin2, g.overdraw,
                  g.opaque_depth);
}

// Rows of the picture that go through raster, shade and resolve together.
struct Band {
  int first_row, rows;
};

// Sample layers of a large picture would not fit into memory: bands of about this many samples do. The bands follow from
// the settings alone, never from the machine, because a band's pixels may differ in the last bit from a whole picture's.
constexpr std::size_t kSamplesPerBand = std::size_t{1} << 23;

std::vector<Band> bands_of(const RenderSettings& s) {
  const std::size_t per_row = static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.samples);
  const int most = static_cast<int>(std::max<std::size_t>(1, kSamplesPerBand / per_row));
  const int count = (s.height + most - 1) / most, rows = (s.height + count - 1) / count;
  std::vector<Band> bands;
  for (int y = 0; y < s.height; y += rows) bands.push_back({y, std::min(rows, s.height - y)});
  return bands;
}

CameraView view_of_band(CameraView view, const Band& band) {
  view.center_y -= static_cast<float>(band.first_row);
  view.height = band.rows;
  return view;
}

// What all bands share.
struct Frame {
  const Scene& scene;
  CameraView view;
  SegmentNumbering numbering;
  MeshTracer meshes;
  LightRig rig;
};

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

void render_band(const Frame& frame, const Band& band, Stages& stages, Image& linear) {
  const RenderSettings& settings = frame.scene.settings;
  const CameraView view = view_of_band(frame.view, band);
  const auto positions = sample_positions(settings.samples);
  const std::span<const Vec2> samples(positions.data(), static_cast<std::size_t>(settings.samples));
  const bool analytic = settings.alpha == AlphaSource::kAnalytic;
  const std::uint64_t pixels = static_cast<std::uint64_t>(view.width) * static_cast<std::uint64_t>(view.height);

  OpaqueLayer opaque;
  if (!frame.meshes.empty())
    stages.run("opaque", "samples", [&](const Progress&) {
      opaque = trace_opaque(frame.scene, view, samples, frame.meshes, frame.rig);
      return StageWork{pixels * samples.size(), bytes_of(opaque.depth, opaque.color)};
    });

  GBuffer gbuffer;
  stages.run("raster", "segments", [&](const Progress& progress) {
    const RasterLayers layers{.center = false, .conservative = analytic, .samples = settings.samples, .analytic = analytic};
    std::swap(gbuffer.opaque_depth, opaque.depth);  // lent, so that it stands in memory once
    const std::uint64_t segments = raster_strands(frame.scene, view, frame.numbering, layers, gbuffer, progress);
    std::swap(gbuffer.opaque_depth, opaque.depth);
    return StageWork{segments, bytes_of(gbuffer)};
  });

  Radiance radiance, edges;
  stages.run("shade", "evaluations", [&](const Progress&) {
    radiance = shade(frame.scene, view, frame.numbering, gbuffer, frame.rig, samples);
    if (analytic)
      edges = shade(frame.scene, view, frame.numbering, edge_layer(gbuffer), frame.rig, std::array{Vec2(0.5f, 0.5f)});
    return StageWork{radiance.color.size() + edges.color.size(),
                     bytes_of(radiance.index, edges.index) + bytes_of(radiance.color, edges.color)};
  });

  gbuffer.sample_keys.release();  // every strand that they show has its color
  stages.run("composite", "pixels", [&](const Progress&) {
    if (linear.pixels.empty()) linear = Image(settings.width, settings.height, {"R", "G", "B", "A"});
    resolve({gbuffer, radiance, edges, opaque, make_backdrop(frame.scene, view)}, settings, band.first_row, linear);
    return StageWork{pixels, linear.pixels.size() * sizeof(float)};
  });
}

Image render_beauty(const Frame& frame, Stages& stages) {
  const RenderSettings& settings = frame.scene.settings;
  Image linear;  // made by the first band that is ready for it
  const std::vector<Band> bands = bands_of(settings);
  for (std::size_t i = 0; i < bands.size(); ++i) {
    stages.set_band(static_cast<int>(i), static_cast<int>(bands.size()));
    render_band(frame, bands[i], stages, linear);
  }
  stages.set_band(0, 1);
  return linear;
}

// One sample in the middle of each pixel, no light.
DebugView render_debug_view(const Frame& frame, Stages& stages) {
  const View what = frame.scene.settings.view;
  const std::array middle{Vec2(0.5f, 0.5f)};
  GBuffer gbuffer;
  OpaqueLayer opaque = trace_opaque(frame.scene, frame.view, middle, frame.meshes, frame.rig);
  stages.run("raster", "segments", [&](const Progress& progress) {
    const RasterLayers layers{.analytic = what == View::kCoverage, .overdraw = what == View::kOverdraw};
    std::swap(gbuffer.opaque_depth, opaque.depth);
    const std::uint64_t segments = raster_strands(frame.scene, frame.view, frame.numbering, layers, gbuffer, progress);
    return StageWork{segments, bytes_of(gbuffer)};
  });
  DebugView view;
  stages.run("composite", "pixels", [&](const Progress&) {
    view = make_debug_view(frame.scene, frame.view, frame.numbering, gbuffer, what);
    return StageWork{gbuffer.center.size(), (view.data.pixels.size() + view.display.pixels.size()) * sizeof(float)};
  });
  return view;
}

}  // namespace

RenderResult render(const Scene& scene, const Progress& progress) {
  const RenderSettings& settings = scene.settings;
  check_settings(settings);
  Stages stages(progress);
  stages.note("groom", "points", groom_work(scene));
  const CameraView view = make_camera_view(scene.camera, settings.width, settings.height);
  Frame frame{scene, view, number_segments(scene, view), MeshTracer(scene.meshes), {}};

  RenderResult result;
  if (settings.view == View::kBeauty) {
    stages.run("light", "maps", [&](const Progress&) {
      frame.rig = prepare_lights(scene, frame.meshes);
      return StageWork{frame.rig.lights.size(), resident_bytes(frame.rig)};
    });
    result.linear = render_beauty(frame, stages);
    stages.run("display", "pixels", [&](const Progress&) {
      result.display = make_display(result.linear, settings.tone_map);
      return StageWork{result.display.pixels.size() / 4, result.display.pixels.size() * sizeof(float)};
    });
  } else {
    DebugView debug = render_debug_view(frame, stages);
    result.linear = std::move(debug.data);
    result.display = std::move(debug.display);
  }
  result.stats = stages.take();
  return result;
}

}  // namespace pelage
