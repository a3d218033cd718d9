#include "frame/deferred_frame.h"

#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

#include "composite/composite.h"
#include "filter/reconnect.h"
#include "frame/sample_positions.h"
#include "groom/hairmesh/prepared.h"
#include "lod/bundle_lod.h"
#include "raster/deferred.h"
#include "raster/opaque.h"
#include "shade/deferred.h"

namespace pelage {
namespace {

/// Strands that the maps of all lights are drawn from.
constexpr double kLightStrands = 50000;
/// Points of each.
constexpr std::uint32_t kLightPoints = 33;

std::uint64_t bytes_of(const DeferredBuffer& b) { return b.center.bytes() + b.conservative.bytes() + b.sample_keys.bytes(); }

}  // namespace

DeferredGrooms prepare_deferred(const Scene& scene) {
  constexpr std::size_t kMostGrooms = std::size_t{kUvCells} * kUvCells;
  if (scene.grooms.size() > kMostGrooms)
    throw Error("scene", "grooms", fmt::format("{} of them", scene.grooms.size()),
                fmt::format("method swr draws {} at most", kMostGrooms));
  DeferredGrooms grooms;
  for (std::uint32_t g = 0; g < scene.grooms.size(); ++g) {
    const GroomInstance& groom = scene.grooms[g];
    if (!groom.hair_mesh)
      throw Error("scene", groom.name, "method swr draws hair meshes, and this groom is none",
                  "make one from it with `pelage fit hairmesh`, or use another method");
    validate(*groom.hair_mesh, groom.name);
    if (!(groom.lod_lambda >= 0.01f && groom.lod_lambda <= 1000))
      throw Error("scene", groom.name, fmt::format("lod_lambda {} is out of range", groom.lod_lambda), "0.01…1000");
    grooms.meshes.push_back({g, std::make_shared<const PreparedHairMesh>(groom.hair_mesh)});
  }
  return grooms;
}

Scene light_stand_in(const Scene& scene) {
  double strands = 0;
  for (const GroomInstance& groom : scene.grooms) strands += static_cast<double>(strand_count(*groom.hair_mesh));
  const double share = std::min(1.0, kLightStrands / std::max(1.0, strands));
  Scene stand_in = scene;
  for (GroomInstance& groom : stand_in.grooms) {
    auto some = std::make_shared<const StrandSet>(expand(*groom.hair_mesh, {kLightPoints, static_cast<float>(share)}));
    groom.width_scale *= static_cast<float>(strand_count(*groom.hair_mesh)) / static_cast<float>(some->strand_count());
    groom.strands = std::move(some);
  }
  return stand_in;
}

HairPicture render_hair(const FrameInputs& inputs, const DeferredGrooms& grooms, const Buffer<float>& opaque_depth,
                        Stages& stages, HairWork* work) {
  const Scene& scene = inputs.scene;
  const RenderSettings& settings = scene.settings;
  const bool sampled = settings.samples > 1, filtered = settings.swr.filter && !sampled;

  LodSelection selection;
  stages.run("lod", "strands", [&](const Progress&) {
    selection = select_lod(scene, grooms.meshes, inputs.view);
    return StageWork{selection.strands, selection.bundles.size() * sizeof(BundleDraw)};
  });

  DeferredBuffer buffer;
  stages.run("raster", "points", [&](const Progress& progress) {
    place_deferred(scene, grooms.meshes, selection, inputs.view, buffer);
    const DeferredLayers layers{.center = !sampled,
                                .conservative = filtered,
                                .samples = sampled ? settings.samples : 0,
                                .coverage = filtered && settings.swr.alpha == SwrAlpha::kCoverage};
    raster_hair_meshes(scene, grooms.meshes, selection, inputs.view, layers, opaque_depth, buffer, progress);
    return StageWork{selection.points, bytes_of(buffer)};
  });

  Radiance radiance;
  stages.run("shade", "evaluations", [&](const Progress&) {
    const auto positions = sample_positions(settings.samples);
    radiance = shade_deferred(scene, grooms.meshes, selection, buffer, grooms.materials,
                              std::span(positions).first(static_cast<std::size_t>(settings.samples)));
    return StageWork{radiance.color.size(), radiance.index.bytes() + radiance.color.bytes()};
  });

  HairPicture hair;
  stages.run(filtered ? "filter.reconnect" : "filter.samples", "pixels", [&](const Progress&) {
    hair = filtered ? reconnect(buffer, radiance, settings.swr, buffer.coverage) : mean_of_samples(buffer, radiance);
    return StageWork{hair.color.size(), hair.color.bytes()};
  });
  if (work) *work = {selection.strands, selection.points, radiance.color.size()};
  return hair;
}

Image render_deferred(const FrameInputs& inputs, const DeferredGrooms& grooms, Stages& stages) {
  const Scene& scene = inputs.scene;
  const RenderSettings& settings = scene.settings;
  OpaqueLayer opaque;
  if (!inputs.meshes.empty())
    stages.run("opaque", "samples", [&](const Progress&) {
      const auto positions = sample_positions(settings.samples);
      opaque = trace_opaque(scene, inputs.view, std::span(positions).first(static_cast<std::size_t>(settings.samples)),
                            inputs.meshes, inputs.rig);
      return StageWork{opaque.depth.size(),
                       opaque.depth.bytes() + opaque.color.bytes() + opaque.first.bytes() + opaque.shade.bytes()};
    });
  const HairPicture hair = render_hair(inputs, grooms, opaque.depth, stages);
  Image linear;
  stages.run("composite", "pixels", [&](const Progress&) {
    linear = hair_over(hair, opaque, make_backdrop(scene, inputs.view), settings.width, settings.height, settings.exposure);
    return StageWork{linear.pixels.size() / 4, linear.pixels.size() * sizeof(float)};
  });
  return linear;
}

}  // namespace pelage
