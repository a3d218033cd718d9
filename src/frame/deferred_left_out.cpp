// In place of method swr where a build leaves hair meshes out.
#include <pelage/error.h>

#include "frame/deferred_frame.h"

namespace pelage {

DeferredGrooms prepare_deferred(const Scene&) {
  throw Error("settings", "method", "this build of Pelage has no hair meshes, which method swr draws",
              "build it with -D PELAGE_HAIRMESH=ON, or use another method");
}
DeferredMaterials::DeferredMaterials(const Scene&, std::span<const DeferredGroom>, const LightRig&) {}
Scene light_stand_in(const Scene& scene) { return scene; }
std::vector<Image> render_deferred(std::span<const FrameInputs>, const DeferredGrooms&, Stages&) { return {}; }

}  // namespace pelage
