#include "shade/deferred.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <array>
#include <cmath>
#include <cstring>

#include "core/mesh_tracer.h"
#include "frame/camera_view.h"
#include "kit/hair_mesh_scene.h"
#include "light/light.h"
#include "lod/bundle_lod.h"
#include "raster/deferred.h"

namespace pelage {
namespace {

using testing::deferred_grooms;
using testing::every_operator;
using testing::hair_mesh_scene;
using testing::small_hair_mesh;

constexpr std::array kPixelCenter{Vec2(0.5f, 0.5f)};

/// The strands of the scene's hair meshes beside them, for the maps of the lights.
Scene with_strands(Scene scene) {
  expand_hair_meshes(scene);
  return scene;
}

struct Shaded {
  Radiance radiance;
  double luminance = 0;  // mean over hair
};

Shaded shade(const Scene& scene, const LightRig& rig, int size = 96) {
  const CameraView view = make_camera_view(scene.camera, size, size);
  const std::vector<DeferredGroom> grooms = deferred_grooms(scene);
  const LodSelection selection = select_lod(scene, grooms, view);
  DeferredBuffer buffer;
  place_deferred(scene, grooms, selection, view, buffer);
  raster_hair_meshes(scene, grooms, selection, view, {}, {}, buffer);
  Shaded s{shade_deferred(scene, grooms, selection, buffer, {scene, grooms, rig}, kPixelCenter)};
  for (const Vec3 c : s.radiance.color) s.luminance += kernel::v_luminance(c);
  s.luminance /= static_cast<double>(s.radiance.color.size());
  return s;
}

/// Dense hair from the front, lit from there.
Scene lit_scene() {
  HairMesh mesh = small_hair_mesh({{StyleOperator::Kind::kNoise, 0.004f, 3, 0, 0.3f}}, 2, 5, 3000);
  Scene scene = hair_mesh_scene(std::move(mesh));
  scene.lights.push_back({});
  scene.lights[0].direction = normalize(Vec3(-0.3f, -0.4f, -1));
  scene.settings.opacity_map_size = 256;
  return scene;
}

TEST(DeferredShade, SameBitsForAnyThreadsAndInstructionSet) {
  const Scene scene = lit_scene();
  const LightRig rig = prepare_lights(with_strands(scene), MeshTracer({}));
  const Shaded expected = shade(scene, rig);
  EXPECT_GT(expected.radiance.color.size(), 500u);
  const auto same = [&] {
    const Shaded s = shade(scene, rig);
    return s.radiance.color.size() == expected.radiance.color.size() &&
           std::memcmp(s.radiance.color.data(), expected.radiance.color.data(), s.radiance.color.bytes()) == 0;
  };
  set_thread_count(1);
  EXPECT_TRUE(same());
  set_thread_count(0);
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    EXPECT_TRUE(same()) << isa;
  }
  set_isa("");
}

// Lipp 2026, figure 4: with strands left out, those that are now in front lie deep in the hair that the maps still know, and go
// dark. Eq. 8 brings the light back; so does it to let strands take over the width of those that are gone.
TEST(DeferredShade, StrandsThatAreLeftOutCastNoShadow) {
  Scene scene = lit_scene();
  const LightRig rig = prepare_lights(with_strands(scene), MeshTracer({}));
  scene.settings.swr.lod = false;
  const double full = shade(scene, rig).luminance;
  scene.settings.swr.lod = true, scene.settings.swr.thicken = false;
  scene.grooms[0].lod_lambda = 0.1f;  // 4 % of the strands
  scene.settings.swr.depth_correction = false;
  const double naive = shade(scene, rig).luminance;
  scene.settings.swr.depth_correction = true;
  const double corrected = shade(scene, rig).luminance;
  scene.settings.swr.thicken = true;
  const double thick = shade(scene, rig).luminance;
  EXPECT_LT(naive, 0.65 * full);
  EXPECT_GT(corrected, 0.75 * full);  // an additive shift cannot make all of it good
  EXPECT_LT(corrected, 1.1 * full);
  EXPECT_NEAR(thick, full, 0.06 * full);
}

TEST(DeferredShade, MapsColorHairByItsPlace) {
  Scene scene = lit_scene();
  const LightRig rig = prepare_lights(with_strands(scene), MeshTracer({}));
  auto red_and_blue = std::make_shared<Image>(2, 1, std::vector<std::string>{"R", "G", "B"});
  red_and_blue->pixels = {0.6f, 0.02f, 0.02f, 0.02f, 0.02f, 0.6f};
  scene.grooms[0].color_along = red_and_blue;
  const CameraView view = make_camera_view(scene.camera, 96, 96);
  const std::vector<DeferredGroom> grooms = deferred_grooms(scene);
  const LodSelection selection = select_lod(scene, grooms, view);
  DeferredBuffer buffer;
  place_deferred(scene, grooms, selection, view, buffer);
  raster_hair_meshes(scene, grooms, selection, view, {}, {}, buffer);
  const Radiance r = shade_deferred(scene, grooms, selection, buffer, {scene, grooms, rig}, kPixelCenter);
  int red = 0, blue = 0;
  for (std::size_t p = 0; p < r.index.size(); ++p) {
    if (r.index[p] == Radiance::kNone) continue;
    const Vec3 c = r.color[r.index[p]];
    const bool root = deferred::w_cell(buffer.center[p]) < 32;
    EXPECT_EQ(c.x > c.z, root);
    ++(root ? red : blue);
  }
  EXPECT_GT(red, 100);
  EXPECT_GT(blue, 100);
}

}  // namespace
}  // namespace pelage
