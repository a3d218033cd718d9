#include "frame/material_map.h"

#include <gtest/gtest.h>
#include <pelage/hair_mesh_styles.h>
#include <pelage/render.h>
#include <pelage/trace.h>

#include <cmath>
#include <memory>

namespace pelage {
namespace {

/// Numbers of one channel, row by row.
std::shared_ptr<const Image> factors(int width, int height, std::vector<float> values) {
  auto map = std::make_shared<Image>(width, height, std::vector<std::string>{"Y"});
  map->pixels = std::move(values);
  return map;
}

TEST(RoughnessLevels, AreTheProductsOfBothMaps) {
  GroomInstance groom;
  groom.hair_mesh = std::make_shared<HairMesh>();
  EXPECT_EQ(RoughnessLevels(groom).values(), std::vector<float>{1});
  groom.roughness_map = factors(2, 2, {2, 0.5f, 2, 2});
  groom.roughness_along = factors(3, 2, {1, 3, 1, 9, 9, 9});  // of whose rows the first one counts
  const RoughnessLevels levels(groom);
  EXPECT_EQ(levels.values(), (std::vector<float>{0.5f, 1.5f, 2, 6}));
  EXPECT_EQ(levels.nearest(0), 0u);
  EXPECT_EQ(levels.nearest(0.5f), 0u);
  EXPECT_EQ(levels.nearest(1.6f), 1u);
  EXPECT_EQ(levels.nearest(1.9f), 2u);
  EXPECT_EQ(levels.nearest(7), 3u);
  EXPECT_EQ(mapped_finish(groom, {0.9f, 0.1f, 0.5f}).roughness, 1.5f);
  EXPECT_EQ(mapped_finish(groom, {0.9f, 0.1f, 0.5f}).tilt, 1);
  groom.tilt_map = factors(2, 1, {-1, NAN});
  EXPECT_EQ(mapped_finish(groom, {0, 0, 0}).tilt, 0);
  EXPECT_EQ(mapped_finish(groom, {1, 0, 0}).tilt, 0);
  groom.hair_mesh = nullptr;
  EXPECT_FALSE(has_finish_maps(groom)) << "maps are those of hair meshes";
}

TEST(Finish, EndsWhereSceneFilesEnd) {
  const HairMaterial m;
  const HairMaterial same = finished(m, {});
  EXPECT_EQ(same.beta_longitudinal, m.beta_longitudinal);
  EXPECT_EQ(same.beta_azimuthal, m.beta_azimuthal);
  EXPECT_EQ(same.cuticle_tilt, m.cuticle_tilt);
  constexpr float kDegree = 3.14159265f / 180;
  const HairMaterial least = finished(m, {0, 0}), most = finished(m, {100, 100});
  EXPECT_FLOAT_EQ(least.beta_longitudinal, 0.5f * kDegree);
  EXPECT_FLOAT_EQ(least.beta_azimuthal, 0.5f * kDegree);
  EXPECT_EQ(least.cuticle_tilt, 0);
  EXPECT_FLOAT_EQ(most.beta_longitudinal, 60 * kDegree);
  EXPECT_FLOAT_EQ(most.beta_azimuthal, 90 * kDegree);
  EXPECT_FLOAT_EQ(most.cuticle_tilt, 15 * kDegree);
}

/// A little hair that scatters by Chiang's model, of which no renderer has a table by angle: the same material, the same bits.
Scene small_scene() {
  Scene scene;
  GroomInstance& groom = scene.grooms.emplace_back();
  groom.hair_mesh = std::make_shared<HairMesh>(make_hair_mesh({.strands = 1000, .width = 4e-4f, .occlusion = false}));
  groom.material.model = HairMaterial::Model::kChiang;
  groom.material.color_source = HairMaterial::ColorSource::kRgb;
  scene.settings.width = 48, scene.settings.height = 48, scene.settings.samples = 1;
  scene.settings.opacity_map_size = 64;
  add_default_camera(scene);
  add_default_lights(scene);
  return scene;
}

// Maps that hold one value make the hair of that material, maps that hold two do not.
template <class MakePicture>
void expect_maps_are_read(const MakePicture& picture) {
  Scene uniform = small_scene(), mapped = uniform;
  HairMaterial& m = uniform.grooms[0].material;
  m.beta_longitudinal *= 0.5f, m.beta_azimuthal *= 0.5f, m.cuticle_tilt *= 2;
  GroomInstance& groom = mapped.grooms[0];
  groom.roughness_map = factors(2, 1, {0.5f, 0.5f}), groom.tilt_along = factors(1, 1, {2});
  const Image expected = picture(uniform);
  EXPECT_EQ(picture(mapped).pixels, expected.pixels);
  groom.roughness_map = factors(2, 1, {0.5f, 1.5f});
  EXPECT_NE(picture(mapped).pixels, expected.pixels);
  groom.roughness_map = factors(2, 1, {0.5f, 0.5f}), groom.tilt_along = factors(2, 1, {2, 0});
  EXPECT_NE(picture(mapped).pixels, expected.pixels);
}

TEST(MaterialMaps, AreReadByEveryRenderer) {
  if (hair_mesh_style_names().empty()) GTEST_SKIP() << "a build without hair meshes";
  for (const Method method : {Method::kMsaa, Method::kSwr}) {
    SCOPED_TRACE(method == Method::kSwr ? "swr" : "msaa");
    expect_maps_are_read([&](Scene scene) {
      scene.settings.method = method;
      return render(scene).linear;
    });
  }
  for (const Integrator integrator : {Integrator::kPath, Integrator::kDual}) {
    SCOPED_TRACE(integrator == Integrator::kPath ? "path" : "dual");
    expect_maps_are_read([&](const Scene& scene) {
      TraceSettings settings;
      settings.integrator = integrator, settings.samples = 2, settings.max_bounces = 4;
      return trace(scene, settings).linear;
    });
  }
}

}  // namespace
}  // namespace pelage
