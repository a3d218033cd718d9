// Hair of one sample a pixel made whole, in the pictures of any renderer: strand linking on a G-buffer.
#pragma once

#include <pelage/image.h>
#include <pelage/progress.h>
#include <pelage/render.h>
#include <pelage/scene.h>
#include <pelage/trace.h>

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace pelage {

/// A channel that denoise() reads, or several of one name: position.X, position.Y, position.Z.
struct GBufferField {
  std::string name;                     ///< "position"
  std::vector<std::string> components;  ///< "X", "Y", "Z"; empty: one channel that is called as the field
  bool required = false;
  std::string meaning;  ///< one line, with unit and what is taken where it is not there
};
/// All of them. `color` is R, G, B without a name in front, `alpha` A and `depth` Z; `tangent` (with `position`) or `screen`
/// has to be there.
const std::vector<GBufferField>& gbuffer_fields();

struct DenoiseSettings {
  /// With its kernel_size 0 the filter is longer for color than for opacity, the more the noisier the samples' colors are.
  /// Another one holds for both.
  LinkSettings link;
  /// Visibility pixels a pixel of the result: 1, 4, 9 or 16. A G-buffer for 4 is twice as wide and high as the result.
  int samples = 1;
  /// What fields are called in the G-buffer, where not by their own name: {"position", "ViewLayer.Position"}. Its components are
  /// then X, Y, Z or R, G, B; a single channel may have an own component.
  std::map<std::string, std::string> names;
  /// Pixels that a strand goes on straight where no more of its samples are seen; not read with `scene`.
  float reach = 16;
  /// Pixels of a strand that its opacity is counted over, > 0; not read with `scene`, whose spans count.
  float piece = 10;
  /// The scene whose grooms and camera the G-buffer shows: strands are then those of the grooms (`groom` and `strand` number them from
  /// 1), and not made from the samples. Its settings are not read. May be null; not kept.
  const Scene* scene = nullptr;
};

struct DenoiseResult {
  Image linear;                 ///< R, G, B, A; scene-linear, premultiplied where A < 1
  std::size_t hair_pixels = 0;  ///< of the G-buffer
  std::size_t strands = 0;      ///< that it shows
  /// Pixels, root of the mean square, between samples and what the camera that was fitted to `position` makes of them.
  std::optional<float> camera_error;
  float noise = 0;                     ///< of the samples' colors: 0 none, 1 as much as strands differ
  float radius = 0, color_radius = 0;  ///< r of the filter for opacity and for color, pixels; 0 where it has not filtered
  std::vector<StageStat> stats;
};

/// Links, thins and smooths the strands of a G-buffer with one sample a pixel (docs/denoise.md; Huang 2025).
///
/// Pixels without hair stay as they are. Throws Error on a field that is missing (naming those that are there), on values that are
/// not finite or out of range (naming the pixel), on positions that no camera sees where they are, and on a scene that does not fit.
/// Untrusted-input safe. Same bits for any number of threads.
DenoiseResult denoise(const Image& gbuffer, const DenoiseSettings& settings = {}, const Progress& progress = {});

/// The G-buffer that `render()` of `scene` with Method::kLink starts from, `settings.samples` visibility pixels a pixel: every field
/// of gbuffer_fields() but `screen`; `coverage` (exact area) with LinkAlpha::kCoverage.
Image render_gbuffer(const Scene& scene, const Progress& progress = {});

/// Layers that make a path-traced picture of one sample a pixel a G-buffer; its background is left to denoise().
std::vector<TraceLayer> gbuffer_layers();

}  // namespace pelage
