#include "frame/methods.h"

#include <pelage/error.h>

#include <array>
#include <span>

#include "filter/frame_mean.h"
#include "frame/sample_positions.h"

namespace pelage {
namespace {

constexpr std::array kPixelCenter{Vec2(0.5f, 0.5f)};

/// The view whose pixel centers lie at `position` of the pixels of `view`.
CameraView jittered(CameraView view, Vec2 position) {
  view.center_x += 0.5f - position.x;
  view.center_y += 0.5f - position.y;
  return view;
}

/// All samples of a pixel from one frame; those that see the same segment share its shade.
Image multisampled(const FrameInputs& inputs, Stages& stages) {
  const auto positions = sample_positions(inputs.scene.settings.samples);
  return render_frame(inputs, std::span(positions).first(static_cast<std::size_t>(inputs.scene.settings.samples)), stages);
}

/// A frame for every sample, each shaded where it is.
Image supersampled(FrameInputs& inputs, Stages& stages) {
  const CameraView still = inputs.view;
  const int samples = inputs.scene.settings.samples;
  FrameMean mean;
  for (const Vec2 position : pixel_sample_positions(samples)) {
    stages.set_pass(mean.count(), samples);
    inputs.view = jittered(still, position);
    Image frame = render_frame(inputs, kPixelCenter, stages);
    stages.run("filter.ssaa", "pixels", [&](const Progress&) {
      const std::size_t values = frame.pixels.size();
      mean.add(std::move(frame));
      return StageWork{values / 4, values * sizeof(float)};
    });
  }
  stages.set_pass(0, 1);
  inputs.view = still;
  return mean.take();
}

}  // namespace

Image render_beauty(FrameInputs& inputs, Stages& stages) {
  switch (inputs.scene.settings.method) {
    case Method::kMsaa: return multisampled(inputs, stages);
    case Method::kSsaa: return supersampled(inputs, stages);
    default: throw Error("settings", "method", "not in this build", "use msaa or ssaa");
  }
}

}  // namespace pelage
