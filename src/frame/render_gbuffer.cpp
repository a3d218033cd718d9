// The samples that strand linking starts from, as a picture with a channel a number.
#include <pelage/denoise.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "assemble/assemble.h"
#include "core/mesh_tracer.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "frame/check_settings.h"
#include "frame/linked_frame.h"
#include "frame/segment_lookup.h"
#include "light/light.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 16;

/// One pixel's numbers, in the order of the channels.
class PixelWriter {
 public:
  PixelWriter(const Scene& scene, const LinkInput& input)
      : scene_(scene), input_(input), light_(std::exp2(scene.settings.exposure)), spans_(number_spans(scene)) {}

  std::vector<std::string> channels() const {
    std::vector<std::string> names{"R",
                                   "G",
                                   "B",
                                   "A",
                                   "Z",
                                   "groom",
                                   "strand",
                                   "u",
                                   "tangent.X",
                                   "tangent.Y",
                                   "tangent.Z",
                                   "position.X",
                                   "position.Y",
                                   "position.Z",
                                   "background.R",
                                   "background.G",
                                   "background.B",
                                   "background.A",
                                   "thickness"};
    if (!input_.layer.coverage.empty()) names.emplace_back("coverage");
    return names;
  }

  void write(int x, int y, float* out) const {
    const Behind& behind = input_.behind;
    const std::size_t q = behind.index(x, y);
    const Vec4 back = behind.at(q);
    const Vec3 back_color = Vec3(back.x, back.y, back.z) * light_;
    const std::optional<std::size_t> p = in_layer(x, y);
    if (p && input_.layer.visibility[*p].is_hair()) {
      const VisibilitySample& v = input_.layer.visibility[*p];
      const SegmentRef at = find_segment(scene_, spans_, v.primitive());
      const StrandSurface surface = surface_at(scene_, spans_, at, v.t);
      out = put(out, input_.layer.color[*p] * light_);
      for (const float value :
           {1.f, input_.layer.depth[*p], static_cast<float>(at.groom + 1), static_cast<float>(at.strand + 1), surface.u})
        *out++ = value;
      out = put(put(out, surface.tangent), surface.position);
    } else {
      out = put(out, back_color);
      *out++ = back.w;
      *out++ = behind.depth.empty() || !(behind.depth[q] < INFINITY) ? 0 : behind.depth[q];
      out = std::fill_n(out, 9, 0.f);
    }
    out = put(out, back_color);
    *out++ = back.w;
    *out++ = p ? input_.layer.thickness[*p] : 0;
    if (!input_.layer.coverage.empty()) *out = p ? input_.layer.coverage[*p] : 0;
  }

 private:
  static float* put(float* out, Vec3 v) {
    for (const float value : {v.x, v.y, v.z}) *out++ = value;
    return out;
  }
  /// The pixel of the layer; none outside of it.
  std::optional<std::size_t> in_layer(int x, int y) const {
    const StrandLayer& l = input_.layer;
    const int i = x - l.left, j = y - l.top;
    if (!l.contains(i, j)) return std::nullopt;
    return l.index(i, j);
  }

  const Scene& scene_;
  const LinkInput& input_;
  const float light_;
  const SegmentNumbering spans_;
};

Image picture_of(const Scene& scene, const LinkInput& input) {
  const PixelWriter writer(scene, input);
  Image image(input.behind.width, input.behind.height, writer.channels());
  parallel_for(static_cast<std::size_t>(image.height), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (int y = static_cast<int>(first); y < static_cast<int>(last); ++y)
      for (int x = 0; x < image.width; ++x) writer.write(x, y, image.at(x, y));
  });
  return image;
}

}  // namespace

Image render_gbuffer(const Scene& scene, const Progress& progress) {
  if (has_unmade_strands(scene)) {
    Scene made = scene;
    expand_hair_meshes(made, progress);
    return render_gbuffer(made, progress);
  }
  Scene linked = scene;
  RenderSettings& settings = linked.settings;
  settings.method = Method::kLink;
  check_settings(settings);
  const int side = static_cast<int>(std::lround(std::sqrt(static_cast<float>(settings.samples))));
  settings.width *= side, settings.height *= side;
  const CameraView view = make_camera_view(linked.camera, settings.width, settings.height);
  const MeshTracer meshes(linked.meshes);
  Stages stages(progress);
  LightRig rig;
  stages.run("light", "maps", [&](const Progress&) {
    rig = prepare_lights(linked, meshes);
    return StageWork{rig.lights.size(), 0};
  });
  const FrameInputs inputs{linked, meshes, rig, view, number_segments(linked, view)};
  return picture_of(linked, render_strand_layer(inputs, side, settings.link.alpha == LinkAlpha::kCoverage, stages));
}

}  // namespace pelage
