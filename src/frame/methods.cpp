#include "frame/methods.h"

#include <pelage/render.h>

#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "assemble/assemble.h"
#include "composite/composite.h"
#include "composite/debug_view.h"
#include "core/check.h"
#include "filter/frame_mean.h"
#include "filter/fxaa.h"
#include "filter/oidn.h"
#include "filter/smaa.h"
#include "filter/strand_curves.h"
#include "filter/taa.h"
#include "frame/camera_view.h"
#include "frame/deferred_frame.h"
#include "frame/linked_frame.h"
#include "frame/sample_positions.h"

namespace pelage {
namespace {

constexpr std::array kPixelCenter{Vec2(0.5f, 0.5f)};

/// The same frame with pixel centers at `position` of the pixels.
FrameInputs jittered(FrameInputs inputs, Vec2 position) {
  inputs.view.center_x += 0.5f - position.x;
  inputs.view.center_y += 0.5f - position.y;
  return inputs;
}

/// Runs `work`, which works on all pixels of `image`, as stage `name`.
template <class Work>
void run_on(const Image& image, const char* name, Stages& stages, const Work& work) {
  const std::uint64_t pixels = image.pixels.size() / 4;
  stages.run(name, "pixels", [&](const Progress&) {
    work();
    return StageWork{pixels, pixels * 4 * sizeof(float)};
  });
}

Beauty displayed(Image linear, ToneMap tone_map, Stages& stages) {
  Beauty beauty{std::move(linear), {}};
  run_on(beauty.linear, "display", stages, [&] { beauty.display = make_display(beauty.linear, tone_map); });
  return beauty;
}

/// All samples of a pixel from one frame; those that see the same segment share its shade.
Image multisampled(const FrameInputs& inputs, Stages& stages) {
  const auto positions = sample_positions(inputs.scene.settings.samples);
  return render_frame(inputs, std::span(positions).first(static_cast<std::size_t>(inputs.scene.settings.samples)), stages);
}

/// A frame for every sample, each shaded where it is.
Image supersampled(const FrameInputs& inputs, Stages& stages) {
  const int samples = inputs.scene.settings.samples;
  FrameMean mean;
  for (const Vec2 position : pixel_sample_positions(samples)) {
    stages.set_pass(mean.count(), samples);
    Image frame = render_frame(jittered(inputs, position), kPixelCenter, stages);
    run_on(frame, "filter.ssaa", stages, [&] { mean.add(std::move(frame)); });
  }
  stages.set_pass(0, 1);
  return mean.take();
}

/// Edges are found in what a display shows, and smoothed there and in the linear picture.
Beauty fast_approximate(const FrameInputs& inputs, Stages& stages) {
  Beauty b = displayed(render_frame(inputs, kPixelCenter, stages), inputs.scene.settings.tone_map, stages);
  run_on(b.linear, "filter.fxaa", stages, [&] {
    const Buffer<Vec2> offsets = fxaa_offsets(b.display);
    b = {resample(b.linear, offsets, AlphaKind::kPremultiplied), resample(b.display, offsets, AlphaKind::kStraight)};
  });
  return b;
}

Beauty morphological(const FrameInputs& inputs, Stages& stages) {
  Beauty b = displayed(render_frame(inputs, kPixelCenter, stages), inputs.scene.settings.tone_map, stages);
  run_on(b.linear, "filter.smaa", stages, [&] {
    const Buffer<SmaaShares> shares = smaa_shares(b.display);
    b = {smaa_blend(b.linear, shares, AlphaKind::kPremultiplied), smaa_blend(b.display, shares, AlphaKind::kStraight)};
  });
  return b;
}

/// The normal of a strand that faces the eye the most: across its tangent. 0 where no strand is.
Image facing_normals(const Image& tangents, const CameraView& view) {
  Image normals = tangents;
  for (std::size_t i = 0; i < normals.pixels.size(); i += 4) {
    float* n = normals.pixels.data() + i;
    if (!(n[3] > 0)) continue;
    const std::size_t pixel = i / 4, width = static_cast<std::size_t>(view.width);
    const Ray ray = camera_ray(view, static_cast<float>(pixel % width) + 0.5f, static_cast<float>(pixel / width) + 0.5f);
    const Vec3 to_eye = normalize(-ray.direction), tangent(n[0], n[1], n[2]);
    const Vec3 normal = normalize(to_eye - tangent * dot(to_eye, tangent));
    n[0] = normal.x, n[1] = normal.y, n[2] = normal.z;
  }
  return normals;
}

Image denoised(const FrameInputs& inputs, Stages& stages) {
  Image albedo = render_debug_view(inputs, View::kAlbedo, stages).data;
  Image normals = facing_normals(render_debug_view(inputs, View::kTangent, stages).data, inputs.view);
  Image linear = render_frame(inputs, kPixelCenter, stages);
  run_on(linear, "filter.oidn", stages,
         [&] { linear = oidn_denoise(std::move(linear), std::move(albedo), std::move(normals)); });
  return linear;
}

/// The same picture of `side`² visibility pixels a pixel.
FrameInputs with_finer_pixels(const FrameInputs& inputs, int side) {
  const auto s = static_cast<float>(side);
  CameraView view = inputs.view;
  view.focal *= s, view.center_x *= s, view.center_y *= s;
  view.width *= side, view.height *= side;
  return {inputs.scene, inputs.meshes, inputs.rig, view, number_segments(inputs.scene, view)};
}

/// Strand linking, alpha fix and orientation-aware filter over one frame, whose kernel is `kernel_scale` times as large.
Image linked(const FrameInputs& inputs, Stages& stages, Buffer<float>* nearest = nullptr, float kernel_scale = 1) {
  RenderSettings settings = inputs.scene.settings;
  settings.link.kernel_radius *= kernel_scale;
  const int side = static_cast<int>(std::lround(std::sqrt(static_cast<float>(settings.samples))));
  const FrameInputs fine = with_finer_pixels(inputs, side);
  LinkInput input = render_strand_layer(fine, side, settings.link.alpha == LinkAlpha::kCoverage, stages);
  return link_and_filter(std::move(input), GroomCurves(fine.scene, fine.view), settings, stages, nearest);
}

/// One frame more for what the history has, or as many as a first picture takes.
/// make_frame(inputs, depth) is a frame of one sample a pixel, and the depth of what each shows.
template <class Frame>
Image temporal(const FrameInputs& inputs, MethodState& state, Stages& stages, const Frame& make_frame) {
  const int frames = state.history ? 1 : inputs.scene.settings.frames;
  const bool moved = state.history && inputs.before;  // since the history; the frames of a first picture are all of one pose
  if (!state.history) state.history = std::make_unique<TaaHistory>();
  for (int i = 0; i < frames; ++i) {
    stages.set_pass(i, frames);
    const Vec2 position = jitter_position(state.next_frame++);
    TaaFrame frame{{}, {}, inputs.view, position};
    const FrameInputs sampled = jittered(inputs, position);
    frame.color = make_frame(sampled, frame.depth);
    if (moved) render_nearest(sampled, stages, &frame.way);
    run_on(frame.color, "filter.taa", stages, [&] { state.history->add(std::move(frame)); });
  }
  stages.set_pass(0, 1);
  return state.history->picture();
}

/// Frames that are blended stand in for pixels under the kernel: so much smaller is it for `frames` of them. Blending forgets older
/// ones than kMostFrames.
float kernel_scale_for(int frames) {
  constexpr int kMostFrames = 8;
  return std::pow(static_cast<float>(std::min(frames, kMostFrames)), -0.25f);
}

/// TAA of frames of one sample, or of what strand linking makes of each.
Image temporal(const FrameInputs& inputs, MethodState& state, Stages& stages) {
  if (inputs.scene.settings.method == Method::kLinkTaa)
    return temporal(inputs, state, stages, [&](const FrameInputs& frame, Buffer<float>& depth) {
      return linked(frame, stages, &depth, kernel_scale_for(inputs.scene.settings.frames));
    });
  return temporal(inputs, state, stages, [&](const FrameInputs& frame, Buffer<float>& depth) {
    return render_frame(frame, kPixelCenter, stages, &depth);
  });
}

/// What one view sees, by any method that draws strands.
Beauty render_view(const FrameInputs& inputs, MethodState& state, Stages& stages) {
  const ToneMap tone_map = inputs.scene.settings.tone_map;
  switch (inputs.scene.settings.method) {
    case Method::kMsaa:
    case Method::kSwr: break;
    case Method::kSsaa: return displayed(supersampled(inputs, stages), tone_map, stages);
    case Method::kTaa:
    case Method::kLinkTaa: return displayed(temporal(inputs, state, stages), tone_map, stages);
    case Method::kFxaa: return fast_approximate(inputs, stages);
    case Method::kSmaa: return morphological(inputs, stages);
    case Method::kLink: return displayed(linked(inputs, stages), tone_map, stages);
    case Method::kOidn: return displayed(denoised(inputs, stages), tone_map, stages);
  }
  return displayed(multisampled(inputs, stages), tone_map, stages);
}

}  // namespace

MethodState::MethodState() = default;
MethodState::~MethodState() = default;
MethodState::MethodState(MethodState&&) noexcept = default;
MethodState& MethodState::operator=(MethodState&&) noexcept = default;

std::vector<Beauty> render_beauty(std::span<const FrameInputs> views, std::span<MethodState> states,
                                  const DeferredGrooms& grooms, Stages& stages) {
  PELAGE_CHECK(!views.empty() && views.size() == states.size());
  const RenderSettings& settings = views[0].scene.settings;
  std::vector<Beauty> pictures;
  if (settings.method == Method::kSwr) {
    for (Image& linear : render_deferred(views, grooms, stages))
      pictures.push_back(displayed(std::move(linear), settings.tone_map, stages));
    return pictures;
  }
  for (std::size_t v = 0; v < views.size(); ++v) {
    stages.set_view(v, views.size());
    pictures.push_back(render_view(views[v], states[v], stages));
  }
  stages.set_view(0, 1);
  return pictures;
}

}  // namespace pelage
