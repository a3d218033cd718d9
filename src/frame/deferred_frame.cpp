#include "frame/deferred_frame.h"

#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

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

bool is_filtered(const RenderSettings& settings) { return settings.samples == 1 && settings.swr.filter; }

/// What all views share: strands, made once, in the layers of each.
std::vector<DeferredBuffer> raster_views(std::span<const FrameInputs> views, const DeferredGrooms& grooms,
                                         const LodSelection& selection, std::span<const OpaqueLayer> opaque,
                                         const Progress& progress) {
  const Scene& scene = views[0].scene;
  const RenderSettings& settings = scene.settings;
  const Buffer<float> nothing;
  std::vector<DeferredBuffer> buffers(views.size());
  std::vector<DeferredTarget> targets;
  for (std::size_t v = 0; v < views.size(); ++v) {
    place_deferred(scene, grooms.meshes, selection, v, views[v].view, buffers[v]);
    targets.push_back({views[v].view, opaque.empty() ? nothing : opaque[v].depth, buffers[v]});
  }
  const DeferredLayers layers{.center = settings.samples == 1,
                              .conservative = is_filtered(settings),
                              .samples = settings.samples > 1 ? settings.samples : 0,
                              .coverage = is_filtered(settings) && settings.swr.alpha == SwrAlpha::kCoverage};
  raster_hair_meshes(scene, grooms.meshes, selection, targets, layers, progress);
  return buffers;
}

/// From the layers of one view to its hair.
HairPicture shade_and_filter(const Scene& scene, const DeferredGrooms& grooms, const LodSelection& selection,
                             const DeferredBuffer& buffer, Stages& stages, HairWork& work) {
  const RenderSettings& settings = scene.settings;
  Radiance radiance;
  stages.run("shade", "evaluations", [&](const Progress&) {
    const auto positions = sample_positions(settings.samples);
    radiance = shade_deferred(scene, grooms.meshes, selection, buffer, grooms.materials,
                              std::span(positions).first(static_cast<std::size_t>(settings.samples)));
    work.evaluations += radiance.color.size();
    return StageWork{radiance.color.size(), radiance.index.bytes() + radiance.color.bytes()};
  });
  HairPicture hair;
  const bool filtered = is_filtered(settings);
  stages.run(filtered ? "filter.reconnect" : "filter.samples", "pixels", [&](const Progress&) {
    hair = filtered ? reconnect(buffer, radiance, settings.swr, buffer.coverage) : mean_of_samples(buffer, radiance);
    return StageWork{hair.color.size(), hair.color.bytes()};
  });
  return hair;
}

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

std::vector<HairPicture> render_hair(std::span<const FrameInputs> views, const DeferredGrooms& grooms,
                                     std::span<const OpaqueLayer> opaque, Stages& stages, HairWork* work) {
  const Scene& scene = views[0].scene;
  LodSelection selection;
  stages.run("lod", "strands", [&](const Progress&) {
    std::vector<CameraView> cameras;
    for (const FrameInputs& view : views) cameras.push_back(view.view);
    selection = select_lod(scene, grooms.meshes, cameras);
    return StageWork{selection.strands, selection.bundles.size() * sizeof(BundleDraw)};
  });
  std::vector<DeferredBuffer> buffers;
  stages.run("raster", "points", [&](const Progress& progress) {
    buffers = raster_views(views, grooms, selection, opaque, progress);
    std::uint64_t bytes = 0;
    for (const DeferredBuffer& buffer : buffers) bytes += bytes_of(buffer);
    return StageWork{selection.points, bytes};
  });
  HairWork done{selection.strands, selection.points, 0};
  std::vector<HairPicture> pictures;
  for (std::size_t v = 0; v < views.size(); ++v) {
    stages.set_view(v, views.size());
    pictures.push_back(shade_and_filter(scene, grooms, selection, std::exchange(buffers[v], {}), stages, done));
  }
  stages.set_view(0, 1);
  if (work) *work = done;
  return pictures;
}

std::vector<Image> render_deferred(std::span<const FrameInputs> views, const DeferredGrooms& grooms, Stages& stages) {
  const Scene& scene = views[0].scene;
  const RenderSettings& settings = scene.settings;
  const bool meshes = !views[0].meshes.empty();
  std::vector<OpaqueLayer> opaque(meshes ? views.size() : 0);
  for (std::size_t v = 0; v < opaque.size(); ++v) {
    stages.set_view(v, views.size());
    stages.run("opaque", "samples", [&](const Progress&) {
      const auto positions = sample_positions(settings.samples);
      OpaqueLayer& layer = opaque[v];
      layer = trace_opaque(scene, views[v].view, std::span(positions).first(static_cast<std::size_t>(settings.samples)),
                           views[v].meshes, views[v].rig);
      return StageWork{layer.depth.size(),
                       layer.depth.bytes() + layer.color.bytes() + layer.first.bytes() + layer.shade.bytes()};
    });
  }
  stages.set_view(0, 1);
  const std::vector<HairPicture> hair = render_hair(views, grooms, opaque, stages);
  const OpaqueLayer nothing;
  std::vector<Image> pictures(views.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    stages.set_view(v, views.size());
    stages.run("composite", "pixels", [&](const Progress&) {
      pictures[v] = hair_over(hair[v], meshes ? opaque[v] : nothing, make_backdrop(scene, views[v].view), settings.width,
                              settings.height, settings.exposure);
      return StageWork{pictures[v].pixels.size() / 4, pictures[v].pixels.size() * sizeof(float)};
    });
  }
  stages.set_view(0, 1);
  return pictures;
}

}  // namespace pelage
