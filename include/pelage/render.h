// Scene in, picture out.
#pragma once

#include <pelage/image.h>
#include <pelage/progress.h>
#include <pelage/scene.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pelage {

/// One row of `--stats`: a stage by the name it has everywhere (folder, profiler, benchmark).
struct StageStat {
  std::string stage;        ///< e.g. "raster"
  double seconds = 0;       ///< wall time
  std::uint64_t bytes = 0;  ///< memory that the stage's results hold
  std::uint64_t items = 0;  ///< what it worked on …
  std::string unit;         ///< … and what that is: "segments", "samples", …
};

struct RenderResult {
  Image linear;                  ///< R, G, B, A; scene-linear, exposure applied, premultiplied where A < 1
  Image display;                 ///< R, G, B, A; tone-mapped, sRGB-encoded, 0…1
  std::vector<StageStat> stats;  ///< in the order of the stages
};

/// Renders `scene.settings.view` of `scene`; what two eyes see side by side, the left one's on the left, each of the size of the
/// settings. Throws Error on settings out of range. The result has the same bits for
/// any number of threads (see set_thread_count() in <pelage/runtime.h>).
RenderResult render(const Scene& scene, const Progress& progress = {});

/// `scene` with its thick hairs as render() draws them: grooms with GroomInstance::lod become what settings.thick_hairs shows of them from
/// the scene's camera at its size, strands and pieces of thick hairs. What trace() then sees is what render() rasterizes; the hairs
/// are seen from everywhere, but chosen by their width on the screen. Throws Error on settings out of range.
Scene with_thick_hairs(const Scene& scene);

/// Pictures of one scene from a camera that may move from picture to picture, or of one whose hair and meshes move as well. Light maps and
/// the trees of the meshes, which no camera changes, are made once for each pose, and Method::kTaa goes on from picture to picture: the first is that of a camera
/// that stood still for `settings.frames` frames, those after it take one frame each.
class PictureSequence {
 public:
  /// Throws Error on settings out of range. The scene's camera is not read, its previous_camera for the first picture.
  explicit PictureSequence(Scene scene);
  PictureSequence(PictureSequence&&) noexcept;
  PictureSequence& operator=(PictureSequence&&) noexcept;
  ~PictureSequence();

  /// The next picture. Without temporal methods it is what render() makes of the scene with this camera.
  RenderResult next(const Camera& camera, const Progress& progress = {});

  /// The next picture, of things that have moved: what at_frame() (<pelage/animation.h>) makes of the same scene. Motion is from
  /// where the picture before, or the scene of the constructor, had things; the camera is that of `moved`, and its settings are
  /// not read. Throws Error where its grooms and meshes are not as many and of as many points.
  RenderResult next(Scene moved, const Progress& progress = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// `linear` (R, G, B, A; premultiplied) tone-mapped and sRGB-encoded, 0…1. Color is un-premultiplied for the curve and
/// stays straight, as PNG wants it; alpha is copied. O(pixels).
Image make_display(const Image& linear, ToneMap tone_map);

}  // namespace pelage
