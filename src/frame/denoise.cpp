// From a G-buffer to a picture: read, make strands, link and filter.
#include <pelage/denoise.h>
#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/pixel_mask.h"
#include "filter/anisotropic.h"
#include "filter/fill_holes.h"
#include "filter/link.h"
#include "filter/sample_curves.h"
#include "filter/sample_noise.h"
#include "filter/strand_curves.h"
#include "frame/camera_view.h"
#include "frame/curve_basis.h"
#include "frame/hair_samples.h"
#include "frame/linked_frame.h"
#include "frame/sample_positions.h"

namespace pelage {
namespace {

constexpr std::size_t kPixelsPerTask = 1 << 14;
constexpr float kMostGroomError = 2;  // pixels

int check_settings(const Image& gbuffer, const DenoiseSettings& s) {
  const auto require = [](bool sound, const char* name, auto value, const char* range) {
    if (!sound) throw Error("denoise settings", name, fmt::format("{} is out of range", value), range);
  };
  require(is_link_sample_count(s.samples), "samples", s.samples, "1, 4, 9 or 16");
  require(s.link.kernel_size >= 0 && s.link.kernel_size <= 1, "link.kernel_size", s.link.kernel_size, "0…1");
  require(s.link.kernel_radius >= 0 && s.link.kernel_radius <= 64, "link.kernel_radius", s.link.kernel_radius, "0…64");
  require(s.link.falloff > 0, "link.falloff", s.link.falloff, "> 0");
  require(s.link.aspect >= 0 && s.link.aspect <= 1, "link.aspect", s.link.aspect, "0…1");
  require(s.link.sigma > 0, "link.sigma", s.link.sigma, "a positive number of pixels");
  require(s.reach >= 0, "reach", s.reach, "a number of pixels");
  require(s.piece > 0, "piece", s.piece, "a positive number of pixels");
  const int side = static_cast<int>(std::lround(std::sqrt(static_cast<float>(s.samples))));
  if (gbuffer.width % side != 0 || gbuffer.height % side != 0)
    throw Error("G-buffer", "",
                fmt::format("{} × {} pixels do not make pixels of {} samples", gbuffer.width, gbuffer.height, s.samples),
                fmt::format("render it {} times as wide and high as the picture", side));
  return side;
}

/// Where hair is, its background is guessed from the pixels around; the others are what they show.
Buffer<Vec4> seen_background(HairSamples& s) {
  if (!s.background.empty()) return std::move(s.background);
  Buffer<Vec4> behind(s.strand.size());
  Buffer<std::uint8_t> known(s.strand.size());
  parallel_for(behind.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      known[p] = !s.is_hair(p);
      behind[p] = known[p] ? Vec4(s.color[p].x, s.color[p].y, s.color[p].z, s.alpha[p]) : Vec4(0, 0, 0, 1);
    }
  });
  fill_holes(behind, known, s.width, s.height);
  return behind;
}

/// What linking works on: the part of the picture around its hair, and what all of it shows without. Samples of the opaque scene
/// are its depth; where hair is, nobody needs to know it.
LinkInput make_input(HairSamples s, const Buffer<VisibilitySample>& visibility, int side) {
  LinkInput input;
  input.behind.width = s.width, input.behind.height = s.height, input.behind.color = seen_background(s);
  input.behind.depth.resize(s.strand.size());
  parallel_for(s.strand.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      input.behind.depth[p] = s.is_hair(p) ? INFINITY : s.depth[p];
      if (s.is_hair(p)) continue;
      // A background of its own does not tell what is nearer than hair: the picture does.
      input.behind.color[p] = {s.color[p].x, s.color[p].y, s.color[p].z, s.alpha[p]};
      s.color[p] = {}, s.depth[p] = INFINITY;
    }
  });
  StrandLayer& layer = input.layer;
  layer.side = side;
  place_layer(PixelMask(s.width, s.height, [&](std::size_t p) { return s.is_hair(p); }), layer);
  const auto cut = [&](const auto& picture, auto& part) {
    const auto width = static_cast<std::size_t>(layer.width), stride = static_cast<std::size_t>(s.width);
    if (picture.empty()) return;
    part.resize(width * static_cast<std::size_t>(layer.height));
    for (std::size_t y = 0; y < static_cast<std::size_t>(layer.height); ++y)
      std::copy_n(picture.begin() + (y + static_cast<std::size_t>(layer.top)) * stride + static_cast<std::size_t>(layer.left),
                  width, part.begin() + y * width);
  };
  cut(visibility, layer.visibility), cut(s.depth, layer.depth), cut(s.color, layer.color);
  cut(s.coverage, layer.coverage), cut(s.thickness, layer.thickness), cut(input.behind.depth, layer.opaque_depth);
  mark_hair(layer);
  return input;
}

/// The place on a groom that a pixel names.
struct GroomPlace {
  std::uint32_t primitive;
  float t;
};

class GroomPlaces {
 public:
  GroomPlaces(const Scene& scene, const HairSamples& samples) : scene_(scene), samples_(samples), spans_(number_spans(scene)) {}

  GroomPlace at(std::size_t p) const {
    const float g = samples_.groom.empty() ? 1 : samples_.groom[p], s = samples_.strand[p];
    if (!(g >= 1 && g <= static_cast<float>(scene_.grooms.size()))) throw strange(p, "groom", g, scene_.grooms.size());
    const auto groom = static_cast<std::uint32_t>(g) - 1;
    const StrandSet& set = *scene_.grooms[groom].strands;
    if (!(s >= 1 && s <= static_cast<float>(set.strand_count()))) throw strange(p, "strand", s, set.strand_count());
    const auto strand = static_cast<std::uint32_t>(s) - 1;
    const std::uint32_t spans = span_count(set.basis, set.offsets[strand + 1] - set.offsets[strand]);
    if (spans == 0) throw strange(p, "strand", s, 0);
    const float place = std::clamp(samples_.u[p], 0.f, 1.f) * static_cast<float>(spans);
    const std::uint32_t span = std::min(static_cast<std::uint32_t>(place), spans - 1);
    return {spans_.groom_base[groom] + set.offsets[strand] + span, place - static_cast<float>(span)};
  }

 private:
  Error strange(std::size_t p, const char* field, float value, std::size_t most) const {
    const auto width = static_cast<std::size_t>(samples_.width);
    return Error("G-buffer", fmt::format("{} at pixel ({}, {})", field, p % width, p / width),
                 fmt::format("{} is none of the scene's, which are 1 to {}", value, most),
                 "give the groom that was rendered, or none; strands are made from the samples then");
  }

  const Scene& scene_;
  const HairSamples& samples_;
  SegmentNumbering spans_;
};

Buffer<VisibilitySample> visibility_of_groom(const Scene& scene, const HairSamples& samples, const GroomCurves& curves) {
  const GroomPlaces places(scene, samples);
  Buffer<VisibilitySample> visibility(samples.strand.size());
  Buffer<float> off(samples.strand.size());  // pixels between a sample and its strand; 0 without hair
  parallel_for(visibility.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      visibility[p] = {}, off[p] = 0;
      if (!samples.is_hair(p)) continue;
      const GroomPlace place = places.at(p);
      StrandCurve curve = curves.curve_of(place.primitive);
      CurvePoint point;
      off[p] = INFINITY;
      if (!curves.at(curve, static_cast<float>(place.primitive - curve.first_primitive) + place.t, point)) continue;
      const auto width = static_cast<std::size_t>(samples.width);
      off[p] = length(point.screen - Vec2(static_cast<float>(p % width) + 0.5f, static_cast<float>(p / width) + 0.5f));
      visibility[p] = pack_visibility(point.tangent, place.t, place.primitive, false);
    }
  });
  std::vector<float> hair;
  for (std::size_t p = 0; p < off.size(); ++p)
    if (samples.is_hair(p)) hair.push_back(off[p]);
  if (hair.empty()) return visibility;
  const auto middle = hair.begin() + static_cast<std::ptrdiff_t>(hair.size() / 2);
  std::nth_element(hair.begin(), middle, hair.end());
  if (!(*middle <= kMostGroomError))
    throw Error("denoise settings", "scene",
                fmt::format("its strands are {:.1f} pixels away from where the G-buffer shows them (median)", *middle),
                "give the groom and the camera that were rendered, or none; strands are made from the samples then");
  return visibility;
}

/// The scene as the G-buffer's camera sees it.
CameraView view_of(const Scene& scene, const HairSamples& samples) {
  return make_camera_view(scene.camera, samples.width, samples.height);
}

std::size_t count_strands(const HairSamples& samples) {
  std::vector<std::uint64_t> keys;
  for (std::size_t p = 0; p < samples.strand.size(); ++p)
    if (samples.is_hair(p)) keys.push_back(samples.strand_key(p));
  std::sort(keys.begin(), keys.end());
  return static_cast<std::size_t>(std::unique(keys.begin(), keys.end()) - keys.begin());
}

}  // namespace

DenoiseResult denoise(const Image& gbuffer, const DenoiseSettings& settings, const Progress& progress) {
  const int side = check_settings(gbuffer, settings);
  const std::uint64_t pixels = static_cast<std::uint64_t>(gbuffer.width) * static_cast<std::uint64_t>(gbuffer.height);
  Stages stages(progress);
  DenoiseResult result;
  HairSamples samples;
  stages.run("filter.samples", "pixels", [&](const Progress&) {
    samples = read_hair_samples(gbuffer, settings.names);
    if (settings.link.alpha == LinkAlpha::kCoverage && samples.coverage.empty())
      throw Error("G-buffer", "channel coverage", "is not there", "opacity from coverage needs it; use count");
    for (std::size_t p = 0; p < pixels; ++p) result.hair_pixels += samples.is_hair(p);
    result.noise = color_noise(samples);
    return StageWork{pixels, pixels * gbuffer.channel_count() * sizeof(float)};
  });

  std::unique_ptr<StrandCurves> curves;
  Buffer<VisibilitySample> visibility;
  stages.run("filter.curves", "strands", [&](const Progress&) {
    if (settings.scene) {
      auto groom = std::make_unique<GroomCurves>(*settings.scene, view_of(*settings.scene, samples));
      visibility = visibility_of_groom(*settings.scene, samples, *groom);
      result.strands = count_strands(samples);
      curves = std::move(groom);
    } else {
      auto made = std::make_unique<SampleCurves>(samples, SampleCurveSettings{settings.reach, settings.piece});
      visibility = made->take_visibility();
      result.strands = made->strand_count(), result.camera_error = made->camera_error();
      curves = std::move(made);
    }
    return StageWork{result.strands, visibility.bytes()};
  });
  LinkInput input;
  stages.run("filter.visibility", "pixels", [&](const Progress&) {
    input = make_input(std::move(samples), visibility, side);
    return StageWork{pixels, input.layer.visibility.bytes() + input.behind.color.bytes()};
  });
  RenderSettings how;
  how.link = settings.link;
  float color_scale = 1;
  if (how.link.filter && how.link.kernel_size == 0) color_scale = kernel_scale_for_noise(result.noise);
  if (how.link.filter && result.hair_pixels > 0) {
    result.radius = kernel_for(screen_box(input.layer), side, how.link).radius;
    result.color_radius = color_scale * result.radius;
  }
  result.linear = link_and_filter(std::move(input), *curves, how, stages, nullptr, color_scale);
  result.stats = stages.take();
  return result;
}

}  // namespace pelage
