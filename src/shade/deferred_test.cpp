#include "shade/deferred.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <array>
#include <cmath>
#include <cstring>

#include "core/mesh_tracer.h"
#include "frame/camera_view.h"
#include "frame/material_map.h"
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

/// A frame up to its pixels.
struct Drawn {
  std::vector<DeferredGroom> grooms;
  LodSelection selection;
  DeferredBuffer buffer;

  explicit Drawn(const Scene& scene, int size = 96) : grooms(deferred_grooms(scene)) {
    const CameraView view = make_camera_view(scene.camera, size, size);
    selection = select_lod(scene, grooms, std::span(&view, 1));
    place_deferred(scene, grooms, selection, 0, view, buffer);
    const Buffer<float> nothing;
    const DeferredTarget target{view, nothing, buffer};
    raster_hair_meshes(scene, grooms, selection, std::span(&target, 1), {});
  }
};

struct Shaded {
  Radiance radiance;
  double luminance = 0;  // mean over hair
};

Shaded shade(const Scene& scene, const LightRig& rig, int size = 96) {
  const Drawn d(scene, size);
  Shaded s{shade_deferred(scene, d.grooms, d.selection, d.buffer, {scene, d.grooms, rig}, kPixelCenter)};
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
  const DeferredBuffer buffer = Drawn(scene).buffer;
  const Radiance r = shade(scene, rig).radiance;
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

/// Numbers of one channel, row by row.
std::shared_ptr<const Image> factors(int width, int height, std::vector<float> values) {
  auto map = std::make_shared<Image>(width, height, std::vector<std::string>{"Y"});
  map->pixels = std::move(values);
  return map;
}

bool same_colors(const Radiance& a, const Radiance& b) {
  return a.color.size() == b.color.size() && std::memcmp(a.color.data(), b.color.data(), a.color.bytes()) == 0;
}

/// The hair of `scene` with every model, with dual scattering and without, and with a probe.
template <class Look>
void for_every_model(Scene scene, const Look& look) {
  scene.environment.radiance = {0.5f, 0.6f, 0.7f};
  scene.grooms[0].material.color_source = HairMaterial::ColorSource::kRgb;  // whose absorption knows roughness
  for (const bool dual : {true, false}) {
    scene.settings.dual_scattering = dual;
    scene.settings.environment_lighting = dual ? EnvironmentLighting::kPieces : EnvironmentLighting::kProbe;
    const LightRig rig = prepare_lights(with_strands(scene), MeshTracer({}));
    for (const auto model : {HairMaterial::Model::kKajiyaKay, HairMaterial::Model::kMarschner, HairMaterial::Model::kZhu,
                             HairMaterial::Model::kChiang, HairMaterial::Model::kSadeghi, HairMaterial::Model::kPelekis}) {
      SCOPED_TRACE(::testing::Message() << "model " << static_cast<int>(model) << ", dual scattering " << dual);
      scene.grooms[0].material.model = model;
      look(scene, rig);
    }
  }
}

TEST(DeferredShade, MapsOfOnesChangeNothing) {
  for_every_model(lit_scene(), [](Scene scene, const LightRig& rig) {
    const Shaded plain = shade(scene, rig);
    GroomInstance& groom = scene.grooms[0];
    groom.roughness_map = groom.tilt_along = factors(3, 2, {1, 1, 1, 1, 1, 1});
    EXPECT_TRUE(same_colors(shade(scene, rig).radiance, plain.radiance));
    groom.roughness_map = nullptr, groom.roughness_along = groom.tilt_map = groom.tilt_along;
    EXPECT_TRUE(same_colors(shade(scene, rig).radiance, plain.radiance));
  });
}

// Each part of a groom looks like hair that is the same all over.
TEST(DeferredShade, MapsOfTwoValuesAreTwoMaterialsToTheBit) {
  for_every_model(lit_scene(), [](const Scene& scene, const LightRig& rig) {
    const auto with = [&](float roughness, float tilt) {
      Scene uniform = scene;
      HairMaterial& m = uniform.grooms[0].material;
      m.beta_longitudinal *= roughness, m.beta_azimuthal *= roughness, m.cuticle_tilt *= tilt;
      return shade(uniform, rig);
    };
    Scene mapped = scene;
    mapped.grooms[0].roughness_along = factors(2, 1, {0.5f, 2});
    mapped.grooms[0].tilt_map = factors(2, 1, {0, 1.5f});  // over u
    const DeferredBuffer buffer = Drawn(scene).buffer;
    const Radiance r = shade(mapped, rig).radiance;
    const Radiance expected[2][2] = {{with(0.5f, 0).radiance, with(0.5f, 1.5f).radiance},
                                     {with(2, 0).radiance, with(2, 1.5f).radiance}};
    int seen[2][2] = {}, differ = 0;
    for (std::size_t p = 0; p < r.index.size(); ++p) {
      if (r.index[p] == Radiance::kNone) continue;
      const int tip = deferred::w_cell(buffer.center[p]) >= 32, right = deferred::u_cell(buffer.center[p]) >= 32;
      const Vec3 color = r.color[r.index[p]];
      ++seen[tip][right];
      differ += !(color == expected[tip][right].color[r.index[p]]);
    }
    EXPECT_EQ(differ, 0);
    for (const auto& row : seen)
      for (const int count : row) EXPECT_GT(count, 50);
    const bool seen_by_the_model = scene.grooms[0].material.model != HairMaterial::Model::kSadeghi;
    EXPECT_TRUE(!seen_by_the_model || !same_colors(expected[0][0], expected[1][0])) << "roughness is seen";
  });
}

// The hair of a smooth map lies between that of its ends, and near that of its mean.
TEST(DeferredShade, ManyRoughnessesShareTables) {
  Scene scene = lit_scene();
  const LightRig rig = prepare_lights(with_strands(scene), MeshTracer({}));
  std::vector<float> ramp(256);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = 0.5f + 1.5f * static_cast<float>(i) / 255;
  scene.grooms[0].roughness_map = factors(256, 1, ramp);
  const RoughnessLevels levels(scene.grooms[0]);
  EXPECT_EQ(levels.values().size(), RoughnessLevels::kMost);
  EXPECT_FLOAT_EQ(levels.values().front(), 0.5f);
  EXPECT_FLOAT_EQ(levels.values().back(), 2);
  const DeferredBuffer buffer = Drawn(scene).buffer;
  const Radiance r = shade(scene, rig).radiance;
  for (std::size_t i = 0; i < ramp.size(); ++i) {
    const float nearest = levels.values()[levels.nearest(ramp[i])];
    EXPECT_LE(std::fabs(nearest - ramp[i]), 1.5f / 14 + 1e-5f);
  }
  // The exact picture: cells of u that see one texel of the map each, every one shaded with a map of that value alone.
  double error = 0, sum = 0;
  for (const int texel : {2, 70, 130, 250}) {
    Scene alone = scene;
    alone.grooms[0].roughness_map = factors(1, 1, {ramp[static_cast<std::size_t>(texel)]});
    const Radiance expected = shade(alone, rig).radiance;
    for (std::size_t p = 0; p < r.index.size(); ++p) {
      if (r.index[p] == Radiance::kNone || deferred::u_cell(buffer.center[p]) != static_cast<std::uint32_t>(texel / 4))
        continue;
      const Vec3 a = r.color[r.index[p]], b = expected.color[r.index[p]];
      error += std::fabs(a.x - b.x) + std::fabs(a.y - b.y) + std::fabs(a.z - b.z), sum += b.x + b.y + b.z;
    }
  }
  EXPECT_GT(sum, 0);
  EXPECT_LT(error / sum, 0.02);
}

}  // namespace
}  // namespace pelage
