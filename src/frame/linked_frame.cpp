#include "frame/linked_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "composite/composite.h"
#include "core/parallel.h"
#include "core/pixel_mask.h"
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

/// What the layer's pixels show, from the evaluations of shade; `depth` of the opaque scene and `coverage` are those of the
/// whole picture, or empty.
void spread_samples(const Buffer<PixelKey>& keys, int picture_width, const Radiance& radiance,
                    const Buffer<StrandSample>& samples, const Buffer<float>& depth, const Buffer<float>& coverage,
                    StrandLayer& layer) {
  const std::size_t width = static_cast<std::size_t>(layer.width), pixels = width * static_cast<std::size_t>(layer.height);
  layer.visibility.resize(pixels), layer.depth.resize(pixels), layer.color.resize(pixels);
  layer.thickness.resize(pixels);
  if (!depth.empty()) layer.opaque_depth.resize(pixels);
  if (!coverage.empty()) layer.coverage.resize(pixels);
  layer.hair = PixelMask(layer.width, layer.height);
  parallel_for(static_cast<std::size_t>(layer.height), PixelMask::kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t y = first, p = first * width; y < last; ++y) {
      const std::size_t row = (y + static_cast<std::size_t>(layer.top)) * static_cast<std::size_t>(picture_width) +
                              static_cast<std::size_t>(layer.left);
      for (std::size_t q = row; q < row + width; ++q, ++p) {
        const std::uint32_t i = radiance.index[q];
        const bool hair = i != Radiance::kNone;
        if (hair) layer.hair.add(static_cast<int>(q - row), static_cast<int>(y));
        layer.visibility[p] = hair ? samples[i].visibility : VisibilitySample();
        layer.thickness[p] = hair ? samples[i].thickness : 0;
        layer.depth[p] = hair ? key_depth(keys[q]) : INFINITY;
        layer.color[p] = hair ? radiance.color[i] : Vec3();
        if (!depth.empty()) layer.opaque_depth[p] = depth[q];
        if (!coverage.empty()) layer.coverage[p] = coverage[q];
      }
    }
  });
}

/// Where all samples within so many pixels hit, hair is dense: it counts as full without drawing all the strands that lie there.
constexpr int kDenseReach = 2;

/// Which share of each pixel strands cover.
Buffer<float> cover(const FrameInputs& inputs, const Buffer<PixelKey>& center, GBuffer& area, std::uint64_t& segments,
                    const Progress& progress) {
  const int width = inputs.view.width, height = inputs.view.height;
  const PixelMask hit(width, height, [&](std::size_t p) { return center[p] != kEmptyPixel; });
  const PixelMask dense = hit.shrunk(kDenseReach);
  segments = raster_strands(inputs.scene, inputs.view, inputs.numbering, {.center = false, .coverage = true, .full = &dense},
                            area, progress);
  Buffer<float> covered(area.coverage.size());
  parallel_for(covered.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) covered[p] = analytic_coverage(area, p);
  });
  return covered;
}

Buffer<float> nearest_of(const StrandLayer& layer, const Behind& behind) {
  const int side = layer.side, width = behind.width / side, height = behind.height / side;
  Buffer<float> nearest(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int i = x * side - layer.left, j = y * side - layer.top;
      nearest[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
          std::min(layer.contains(i, j) ? layer.depth[layer.index(i, j)] : INFINITY,
                   behind.depth.empty() ? INFINITY : behind.depth[behind.index(x * side, y * side)]);
    }
  return nearest;
}

std::uint64_t bytes_of(const LinkInput& in) {
  const StrandLayer& l = in.layer;
  return l.visibility.bytes() + l.thickness.bytes() + l.depth.bytes() + l.color.bytes() + l.coverage.bytes() +
         l.opaque_depth.bytes() + in.behind.color.bytes() + in.behind.depth.bytes();
}

}  // namespace

void place_layer(const PixelMask& hair, StrandLayer& layer) {
  const PixelBox box = hair.box();
  const int margin = kLayerMargin * layer.side;
  const auto down = [&](int x) { return std::max(0, x - margin) / layer.side * layer.side; };
  const auto up = [&](int x, int end) { return std::min(end, (x + margin + layer.side - 1) / layer.side * layer.side); };
  layer.left = down(box.left), layer.top = down(box.top);
  layer.width = up(box.right, hair.width()) - layer.left, layer.height = up(box.bottom, hair.height()) - layer.top;
}

LinkInput render_strand_layer(const FrameInputs& inputs, int side, bool coverage, Stages& stages) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(inputs.view.width) * static_cast<std::uint64_t>(inputs.view.height);
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
  Buffer<float> covered;
  if (coverage)
    stages.run("raster.coverage", "segments", [&](const Progress& progress) {
      GBuffer area;
      std::swap(area.opaque_depth, gbuffer.opaque_depth);
      std::uint64_t segments = 0;
      covered = cover(inputs, gbuffer.center, area, segments, progress);
      std::swap(area.opaque_depth, gbuffer.opaque_depth);
      return StageWork{segments, area.coverage.bytes()};
    });
  Radiance radiance;
  Buffer<StrandSample> samples;
  stages.run("shade", "evaluations", [&](const Progress&) {
    radiance = shade(inputs.scene, inputs.view, inputs.numbering, gbuffer, inputs.rig, std::array{kPixelCenter}, &samples);
    return StageWork{radiance.color.size(), radiance.color.bytes() + radiance.index.bytes() + samples.bytes()};
  });
  LinkInput input;
  stages.run("filter.visibility", "pixels", [&](const Progress&) {
    input.layer.side = side;
    const auto is_hair = [&](std::size_t p) { return radiance.index[p] != Radiance::kNone; };
    place_layer(PixelMask(inputs.view.width, inputs.view.height, is_hair), input.layer);
    spread_samples(gbuffer.center, inputs.view.width, radiance, samples, gbuffer.opaque_depth, covered, input.layer);
    input.behind = {inputs.view.width,
                    inputs.view.height,
                    std::move(gbuffer.opaque_depth),
                    std::move(opaque),
                    make_backdrop(inputs.scene, inputs.view),
                    {}};
    return StageWork{pixels, bytes_of(input)};
  });
  return input;
}

Image link_and_filter(LinkInput input, const StrandCurves& curves, const RenderSettings& settings, Stages& stages,
                      Buffer<float>* nearest, float color_scale) {
  StrandLayer& layer = input.layer;
  const std::uint64_t pixels = layer.visibility.size();
  Links links;
  if (settings.link.link)
    stages.run("filter.link", "pixels", [&](const Progress&) {
      links = link_strands(layer, curves, settings.link);
      return StageWork{pixels, links.fills.capacity() * sizeof(Fill)};
    });
  Matte matte;
  Buffer<Vec4> filtered;
  AlphaStats stats;
  AnisotropicKernel kernel, color_kernel;
  stages.run("filter.alpha", "pixels", [&](const Progress&) {
    kernel = kernel_for(screen_box(layer), layer.side, settings.link);
    color_kernel = kernel;
    color_kernel.radius = std::min(color_scale * kernel.radius, AnisotropicKernel::kMostRadius);
    matte = fix_alpha(layer, links, settings.link.alpha, color_kernel.reach(), stats);
    return StageWork{pixels, matte.bytes()};
  });
  if (stats.overflow > 0) stages.note("filter.overflow", "fills", {stats.overflow, 0});
  if (nearest) *nearest = nearest_of(layer, input.behind);
  if (settings.link.filter)
    stages.run("filter.anisotropic", "pixels", [&](const Progress&) {
      extend_tangents(matte, layer);
      filtered = filter_apart(matte, kernel, color_kernel);
      return StageWork{pixels, filtered.bytes()};
    });
  Image linear;
  stages.run("composite", "pixels", [&](const Progress&) {
    linear = lay_over(matte, filtered, layer, input.behind, settings.exposure);
    return StageWork{linear.pixels.size() / 4, linear.pixels.size() * sizeof(float)};
  });
  return linear;
}

}  // namespace pelage
