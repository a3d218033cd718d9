#include "frame/linked_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "composite/composite.h"
#include "core/parallel.h"
#include "filter/alpha_fix.h"
#include "filter/anisotropic.h"
#include "filter/link.h"
#include "filter/matte.h"
#include "raster/keys.h"
#include "raster/opaque.h"
#include "raster/raster.h"
#include "shade/shade.h"

namespace pelage {
namespace {

constexpr Vec2 kPixelCenter{0.5f, 0.5f};
constexpr std::size_t kPixelsPerTask = 1 << 14;

/// What is behind the hair of every pixel.
Buffer<Vec4> behind_hair(const FrameInputs& inputs, const Buffer<float>& opaque_depth, const OpaqueLayer& opaque) {
  const Backdrop backdrop = make_backdrop(inputs.scene, inputs.view);
  Buffer<Vec4> behind(static_cast<std::size_t>(inputs.view.width) * static_cast<std::size_t>(inputs.view.height));
  parallel_for(behind.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const bool mesh = !opaque_depth.empty() && opaque_depth[p] < INFINITY;
      const Vec3 c = mesh ? opaque_color(opaque, p) : backdrop.pixels.empty() ? backdrop.color : backdrop.pixels[p];
      behind[p] = {c.x, c.y, c.z, mesh ? 1.f : backdrop.alpha};
    }
  });
  return behind;
}

/// What the pixels of `keys` show, from the evaluations of shade.
void spread_samples(const Buffer<PixelKey>& keys, const Radiance& radiance, const Buffer<VisibilitySample>& samples,
                    StrandLayer& layer) {
  layer.visibility.resize(keys.size());
  layer.depth.resize(keys.size()), layer.color.resize(keys.size());
  parallel_for(keys.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const std::uint32_t i = radiance.index[p];
      const bool hair = i != Radiance::kNone;
      layer.visibility[p] = hair ? samples[i] : VisibilitySample();
      layer.depth[p] = hair ? key_depth(keys[p]) : INFINITY;
      layer.color[p] = hair ? radiance.color[i] : Vec3();
    }
  });
}

Buffer<float> nearest_of(const StrandLayer& layer) {
  const auto side = static_cast<std::size_t>(layer.side), stride = static_cast<std::size_t>(layer.width), width = stride / side;
  Buffer<float> nearest(layer.depth.size() / (side * side));
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const std::size_t p = i / width * side * stride + i % width * side;
    nearest[i] = std::min(layer.depth[p], layer.opaque_depth.empty() ? INFINITY : layer.opaque_depth[p]);
  }
  return nearest;
}

std::uint64_t bytes_of(const StrandLayer& l) {
  return l.visibility.bytes() + l.depth.bytes() + l.color.bytes() + l.coverage.bytes() + l.behind.bytes() +
         l.opaque_depth.bytes();
}

}  // namespace

StrandLayer render_strand_layer(const FrameInputs& inputs, int side, bool coverage, Stages& stages) {
  StrandLayer layer;
  layer.width = inputs.view.width, layer.height = inputs.view.height, layer.side = side;
  const std::uint64_t pixels = static_cast<std::uint64_t>(layer.width) * static_cast<std::uint64_t>(layer.height);
  OpaqueLayer opaque;
  if (!inputs.meshes.empty())
    stages.run("opaque", "samples", [&](const Progress&) {
      opaque = trace_opaque(inputs.scene, inputs.view, std::array{kPixelCenter}, inputs.meshes, inputs.rig);
      return StageWork{pixels, opaque.depth.bytes() + opaque.color.bytes() + opaque.first.bytes() + opaque.shade.bytes()};
    });
  GBuffer gbuffer;
  gbuffer.opaque_depth = std::move(opaque.depth);
  stages.run("raster", "segments", [&](const Progress& progress) {
    const std::uint64_t segments = raster_strands(inputs.scene, inputs.view, inputs.numbering, {}, gbuffer, progress);
    return StageWork{segments, gbuffer.center.bytes()};
  });
  if (coverage)
    stages.run("raster.coverage", "segments", [&](const Progress& progress) {
      GBuffer area;
      std::swap(area.opaque_depth, gbuffer.opaque_depth);
      const std::uint64_t segments =
          raster_strands(inputs.scene, inputs.view, inputs.numbering, {.center = false, .coverage = true}, area, progress);
      layer.coverage.resize(area.coverage.size());
      parallel_for(layer.coverage.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) layer.coverage[p] = analytic_coverage(area, p);
      });
      std::swap(area.opaque_depth, gbuffer.opaque_depth);
      return StageWork{segments, area.coverage.bytes()};
    });
  Radiance radiance;
  Buffer<VisibilitySample> samples;
  stages.run("shade", "evaluations", [&](const Progress&) {
    radiance = shade(inputs.scene, inputs.view, inputs.numbering, gbuffer, inputs.rig, std::array{kPixelCenter}, &samples);
    return StageWork{radiance.color.size(), radiance.color.bytes() + radiance.index.bytes() + samples.bytes()};
  });
  stages.run("filter.visibility", "pixels", [&](const Progress&) {
    spread_samples(gbuffer.center, radiance, samples, layer);
    layer.behind = behind_hair(inputs, gbuffer.opaque_depth, opaque);
    layer.opaque_depth = std::move(gbuffer.opaque_depth);
    return StageWork{pixels, bytes_of(layer)};
  });
  return layer;
}

Image link_and_filter(StrandLayer layer, const StrandCurves& curves, const RenderSettings& settings, Stages& stages,
                      Buffer<float>* nearest) {
  const std::uint64_t pixels = layer.visibility.size();
  Links links;
  if (settings.link.link)
    stages.run("filter.link", "pixels", [&](const Progress&) {
      links = link_strands(layer, curves, settings.link);
      return StageWork{pixels, links.fills.capacity() * sizeof(Fill)};
    });
  Matte matte;
  std::uint64_t overflow = 0;
  stages.run("filter.alpha", "pixels", [&](const Progress&) {
    AlphaStats stats;
    matte = fix_alpha(layer, links, settings.link.alpha, stats);
    overflow = stats.overflow;
    return StageWork{pixels, 6 * matte.r.bytes()};
  });
  if (overflow > 0) stages.note("filter.overflow", "fills", {overflow, 0});
  if (nearest) *nearest = nearest_of(layer);
  if (settings.link.filter)
    stages.run("filter.anisotropic", "pixels", [&](const Progress&) {
      extend_tangents(matte);
      matte = filter_anisotropic(matte, kernel_for(matte, settings.link));
      return StageWork{pixels, 6 * matte.r.bytes()};
    });
  Image linear;
  stages.run("composite", "pixels", [&](const Progress&) {
    linear = lay_over(matte, layer, settings.exposure);
    return StageWork{pixels, linear.pixels.size() * sizeof(float)};
  });
  return linear;
}

}  // namespace pelage
