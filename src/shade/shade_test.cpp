// Shade against single evaluations of the scattering models, and its invariants.
#include "shade/shade.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/rng.h"
#include "frame/camera_view.h"
#include "frame/environment_map.h"
#include "frame/fiber.h"
#include "frame/light_lookup.h"
#include "frame/segment_lookup.h"
#include "kernel/scalar.h"
#include "light/light.h"
#include "frame/sample_positions.h"
#include "shade/evaluate.h"
#include "shade/visible.h"

namespace pelage {
namespace {

constexpr HairMaterial::Model kModels[] = {HairMaterial::Model::kKajiyaKay, HairMaterial::Model::kMarschner,
                                           HairMaterial::Model::kZhu,       HairMaterial::Model::kChiang,
                                           HairMaterial::Model::kSadeghi,   HairMaterial::Model::kPelekis};
constexpr std::array<Vec2, 1> kMiddle{Vec2(0.5f, 0.5f)};

StrandSet linear(const std::vector<std::array<Vec3, 2>>& lines, float width) {
  StrandSet set;
  set.basis = CurveBasis::kLinear;
  set.widths = {width};
  set.offsets = {0};
  for (const auto& line : lines) {
    set.points.insert(set.points.end(), line.begin(), line.end());
    set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
  }
  return set;
}

/// A scene of 32×32 pixels that looks at the origin from +z, one metre away.
Scene scene_of(StrandSet strands) {
  Scene scene;
  scene.grooms.emplace_back().strands = std::make_shared<StrandSet>(std::move(strands));
  scene.settings.width = scene.settings.height = 32;
  scene.settings.opacity_map_size = 64;
  return scene;
}

Light directional(Vec3 travels, Vec3 irradiance) {
  Light light;
  light.direction = normalize(travels), light.intensity = irradiance;
  return light;
}

SegmentNumbering numbering_of(const Scene& scene) {
  SegmentNumbering numbering;
  numbering.groom_base.push_back(0);
  for (const GroomInstance& groom : scene.grooms) {
    numbering.groom_base.push_back(numbering.groom_base.back() + static_cast<std::uint32_t>(groom.strands->point_count()));
    numbering.subdivisions.push_back(1);
  }
  return numbering;
}

/// A G-buffer in which random pixels see random segments: shading does not care whether they could.
GBuffer random_gbuffer(const Scene& scene, int samples) {
  GBuffer g;
  g.width = scene.settings.width, g.height = scene.settings.height, g.samples = samples;
  g.sample_keys.resize(static_cast<std::size_t>(g.width * g.height * samples));
  const std::uint32_t strands = static_cast<std::uint32_t>(scene.grooms[0].strands->strand_count());
  for (std::size_t i = 0; i < g.sample_keys.size(); ++i) {
    Rng rng(5, static_cast<std::uint32_t>(i));
    const std::uint32_t id = 2 * std::min(static_cast<std::uint32_t>(rng.uniform() * 4 * static_cast<float>(strands)), strands);
    g.sample_keys[i] = id < 2 * strands ? PixelKey{0x3f800000u} << 32 | id : kEmptyPixel;
  }
  return g;
}

Scene thicket(HairMaterial::Model model) {
  std::vector<std::array<Vec3, 2>> lines;
  for (std::uint32_t i = 0; i < 300; ++i) {
    Rng rng(9, i);
    const auto point = [&] {
      return Vec3(0.2f * rng.uniform() - 0.1f, 0.2f * rng.uniform() - 0.1f, 0.2f * rng.uniform() - 0.1f);
    };
    const Vec3 a = point();
    lines.push_back({a, point()});
  }
  Scene scene = scene_of(linear(lines, 2e-3f));
  scene.grooms[0].material.model = model;
  Light point, spot;
  point.type = Light::Type::kPoint, point.position = {0.3f, 0.4f, 0.3f};
  spot.type = Light::Type::kSpot, spot.position = {-0.4f, 0.2f, 0.1f}, spot.direction = normalize({1, -0.5f, -0.2f});
  scene.lights = {directional({0.3f, -1, -0.5f}, {3, 3, 2}), point, spot};
  scene.environment.radiance = {0.1f, 0.2f, 0.3f};
  return scene;
}

Radiance shade_all(const Scene& scene, const GBuffer& gbuffer) {
  const CameraView view = make_camera_view(scene.camera, scene.settings.width, scene.settings.height);
  const auto positions = sample_positions(gbuffer.samples);
  return shade(scene, view, numbering_of(scene), gbuffer, prepare_lights(scene, MeshTracer(scene.meshes)),
               {positions.data(), static_cast<std::size_t>(gbuffer.samples)});
}

bool same(const Radiance& a, const Radiance& b) {
  return a.color.size() == b.color.size() && std::equal(a.index.begin(), a.index.end(), b.index.begin(), b.index.end()) &&
         std::memcmp(a.color.data(), b.color.data(), a.color.size() * sizeof(Vec3)) == 0;
}

/// What one strand along +y at the origin sends to the camera at +z, without shadows or multiple scattering.
Vec3 lone_strand(HairMaterial::Model model, Vec3 travels) {
  Scene scene = scene_of(linear({{Vec3(0, -0.5f, 0), Vec3(0, 0.5f, 0)}}, 1e-4f));
  scene.grooms[0].material.model = model;
  scene.settings.shadows = false, scene.settings.dual_scattering = false;
  scene.lights.push_back(directional(travels, {2, 3, 4}));
  GBuffer g;
  g.width = g.height = 32;
  g.center.resize(32 * 32);
  g.center.fill(kEmptyPixel);
  g.center[16 * 32 + 16] = PixelKey{0x3f800000u} << 32;
  const CameraView view = make_camera_view(scene.camera, 32, 32);
  const Radiance r = shade(scene, view, numbering_of(scene), g, prepare_lights(scene, MeshTracer({})), kMiddle);
  EXPECT_EQ(r.color.size(), 1u);
  EXPECT_EQ(r.index[16 * 32 + 16], 0u);
  EXPECT_EQ(r.index[0], Radiance::kNone);
  return r.color[0];
}

TEST(Shade, LoneStrandEqualsItsModel) {
  const HairMaterial material;
  const kernel::ScatterFiber fiber = make_fiber(material, {});
  // The pixel's center lies half a pixel off the optical axis: undo it to find the place on the strand.
  const float y = -0.5f * 2 * std::tan(0.25f) / 32;
  const Vec3 to_eye = normalize(Vec3(0, -y, 1));
  for (const Vec3 travels : {Vec3(0, 0, -1), Vec3(0.5f, -0.4f, -1), Vec3(-1, 0.8f, 0.3f), Vec3(0.1f, 0.2f, 1)}) {
    const Vec3 to_light = -normalize(travels);
    const float sin_o = to_eye.y, cos_o = std::sqrt(1 - sin_o * sin_o), sin_i = to_light.y,
                cos_i = std::sqrt(1 - sin_i * sin_i);
    const float cos_phi = to_light.z / std::sqrt(to_light.x * to_light.x + to_light.z * to_light.z);
    const auto close = [&](Vec3 shaded, Vec3 model) {
      const Vec3 expected = model * Vec3(2, 3, 4);
      EXPECT_NEAR(shaded.x, expected.x, 1e-3f * expected.x + 1e-6f);
      EXPECT_NEAR(shaded.y, expected.y, 1e-3f * expected.y + 1e-6f);
      EXPECT_NEAR(shaded.z, expected.z, 1e-3f * expected.z + 1e-6f);
    };
    const kernel::ScatterLobes m = kernel::scatter_prepare_marschner(fiber, sin_o, cos_o);
    close(lone_strand(HairMaterial::Model::kMarschner, travels), kernel::scatter_marschner(m, sin_i, cos_i, cos_phi));
    close(lone_strand(HairMaterial::Model::kZhu, travels),
          kernel::scatter_zhu(kernel::scatter_prepare_zhu(fiber, sin_o, cos_o), sin_i, cos_i, cos_phi));
    const Vec3 tuft = kernel::scatter_tuft_color(fiber.sigma_a, material.beta_azimuthal);
    close(lone_strand(HairMaterial::Model::kKajiyaKay, travels), kernel::scatter_kajiya_kay(m, tuft, sin_i, cos_i));
    close(lone_strand(HairMaterial::Model::kChiang, travels),
          kernel::scatter_marschner(kernel::scatter_prepare_chiang_far(fiber, sin_o, cos_o), sin_i, cos_i, cos_phi));
    const kernel::ScatterArtist artist = kernel::scatter_prepare_sadeghi(
        make_artist_fiber(material), kernel::scatter_crossing_color(fiber.sigma_a), sin_o, cos_o);
    close(lone_strand(HairMaterial::Model::kSadeghi, travels), kernel::scatter_sadeghi(artist, sin_i, cos_i, cos_phi));
    close(lone_strand(HairMaterial::Model::kPelekis, travels),
          kernel::scatter_pelekis(kernel::scatter_prepare_pelekis(fiber, sin_o, cos_o), sin_i, cos_phi) +
              kernel::scatter_pelekis_diffused(tuft, cos_i));
  }
}

TEST(Shade, SameBitsForAnyThreadsAndInstructionSet) {
  const Scene scene = thicket(HairMaterial::Model::kMarschner);
  const GBuffer g = random_gbuffer(scene, 8);
  set_thread_count(1);
  const Radiance one = shade_all(scene, g);
  EXPECT_GT(one.color.size(), 1000u);
  for (const int threads : {2, 3}) {
    set_thread_count(threads);
    EXPECT_TRUE(same(one, shade_all(scene, g))) << threads;
  }
  set_thread_count(0);
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    EXPECT_TRUE(same(one, shade_all(scene, g))) << isa;
  }
  set_isa("");
}

/// Strands here and there, of any direction and color.
ShadeBatch random_batch() {
  ShadeBatch batch;
  batch.count = 203;
  for (std::uint32_t i = 0; i < ShadeBatch::kSize + ShadeBatch::kPadding; ++i) {
    Rng rng(1, i);
    const auto around = [&] { return 0.3f * rng.uniform() - 0.15f; };
    const Vec3 tangent = normalize({around(), around(), around()}), eye = normalize({around(), around(), 0.2f});
    batch.px[i] = around(), batch.py[i] = around(), batch.pz[i] = around();
    batch.tx[i] = tangent.x, batch.ty[i] = tangent.y, batch.tz[i] = tangent.z;
    batch.ex[i] = eye.x, batch.ey[i] = eye.y, batch.ez[i] = eye.z;
    batch.occlusion[i] = 1 - 0.5f * rng.uniform();
    batch.fibers[i] = 1 + 50 * rng.uniform(), batch.fiber_radius[i] = 4e-5f, batch.lean[i] = 0.2f * rng.uniform();
    batch.half_width[i] = 1e-4f + 4e-3f * rng.uniform(), batch.half_depth[i] = 1e-4f + 4e-3f * rng.uniform();
    batch.absorb_r[i] = rng.uniform(), batch.absorb_g[i] = rng.uniform(), batch.absorb_b[i] = rng.uniform();
  }
  return batch;
}

/// evaluate() on every instruction set against evaluate_scalar(), bit for bit.
void expect_wide_equals_scalar(const ShadeConstants& constants) {
  ShadeBatch batch = random_batch(), scalar = batch;
  evaluate_scalar(constants, scalar);
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    evaluate(constants, batch);
    for (std::size_t i = 0; i < batch.count; ++i) {
      EXPECT_EQ(batch.r[i], scalar.r[i]) << isa << " " << i;
      EXPECT_EQ(batch.g[i], scalar.g[i]) << isa << " " << i;
      EXPECT_EQ(batch.b[i], scalar.b[i]) << isa << " " << i;
      EXPECT_TRUE(std::isfinite(scalar.r[i]) && scalar.r[i] >= 0);
    }
  }
  set_isa("");
}

TEST(Shade, WideEqualsScalar) {
  for (const auto model : kModels) {
    const Scene scene = thicket(model);
    const LightRig rig = prepare_lights(scene, MeshTracer({}));
    for (const bool dual : {true, false})
      for (const bool bundled : {false, true}) {
        ShadeConstants constants = shade_constants(scene.grooms[0].material, dual, rig);
        constants.bundled = bundled;
        expect_wide_equals_scalar(constants);
      }
  }
}

/// Strands under a map alone, by its probe.
ShadeConstants under_probe(const HairMaterial& material, const Scene& scene) {
  static LightRig rig;  // the constants point into it
  rig = prepare_lights(scene, MeshTracer({}));
  EXPECT_TRUE(rig.lights.empty());
  return shade_constants(material, false, rig);
}

/// What a strand makes of a sky, by sums over all directions.
struct SkySums {
  Vec3 single;      ///< Pelekis' lobes
  Vec3 facing;      ///< the Lambertian term by the irradiance of the normal that faces the eye
  Vec3 lambertian;  ///< the Lambertian term itself
};
SkySums summed_over_sky(const HairMaterial& material, const Environment& sky, Vec3 tangent, Vec3 to_eye, Vec3 absorption) {
  const float sin_o = dot(tangent, to_eye), cos_o = std::sqrt(std::max(0.f, 1 - sin_o * sin_o));
  const Vec3 across = normalize(to_eye - tangent * sin_o), side = cross(tangent, across);
  const kernel::ScatterPelekis l =
      kernel::scatter_prepare_pelekis(kernel::scatter_fiber(material.eta, material.beta_longitudinal, material.beta_azimuthal,
                                                            material.cuticle_tilt, material.specular_gain, absorption),
                                      sin_o, cos_o);
  const Vec3 tuft = kernel::scatter_tuft_color(absorption, material.beta_azimuthal);
  constexpr int kSines = 120, kAzimuths = 72;
  constexpr float kArea = 4 * 3.14159265f / (kSines * kAzimuths);
  SkySums sum{};
  for (int i = 0; i < kSines; ++i) {
    const float s = 2 * (static_cast<float>(i) + 0.5f) / kSines - 1, c = std::sqrt(1 - s * s);
    for (int j = 0; j < kAzimuths; ++j) {
      const float phi = (static_cast<float>(j) + 0.5f) / kAzimuths * 6.2831853f, x = c * std::cos(phi);
      const Vec3 light = environment_radiance(sky, tangent * s + across * x + side * (c * std::sin(phi))) * kArea;
      sum.single += light * kernel::scatter_pelekis(l, s, std::cos(phi));
      sum.facing += light * tuft * (kernel::kPelekisDiffused * std::max(x, 0.f) / 3.14159265f);
      sum.lambertian += light * kernel::scatter_pelekis_diffused(tuft, c);
    }
  }
  return sum;
}

Scene under_sky(std::shared_ptr<const Image> map) {
  Scene scene = thicket(HairMaterial::Model::kPelekis);
  scene.lights.clear();
  scene.environment.radiance = {1, 1, 1}, scene.environment.map = std::move(map);
  scene.settings.environment_lighting = EnvironmentLighting::kProbe;
  return scene;
}

/// Bright above the horizon, black below.
std::shared_ptr<const Image> half_bright() {
  auto map = std::make_shared<Image>(128, 64, std::vector<std::string>{"R", "G", "B"});
  std::fill(map->pixels.begin(), map->pixels.begin() + static_cast<std::ptrdiff_t>(map->pixels.size() / 2), 1.f);
  return map;
}

TEST(ShadeProbe, AnEvenSkyIsExact) {
  const Scene scene = under_sky(nullptr);
  const HairMaterial& material = scene.grooms[0].material;
  ShadeBatch batch = random_batch();
  evaluate_scalar(under_probe(material, scene), batch);
  for (std::size_t i = 0; i < batch.count; ++i) {
    const SkySums sums =
        summed_over_sky(material, scene.environment, {batch.tx[i], batch.ty[i], batch.tz[i]},
                        {batch.ex[i], batch.ey[i], batch.ez[i]}, {batch.absorb_r[i], batch.absorb_g[i], batch.absorb_b[i]});
    const Vec3 expected = sums.single + sums.lambertian;
    EXPECT_NEAR(batch.r[i], batch.occlusion[i] * expected.x, 4e-3f * expected.x) << i;
    EXPECT_NEAR(batch.b[i], batch.occlusion[i] * expected.z, 4e-3f * expected.z) << i;
  }
}

// RMS over the directions of strand and eye, over the mean of what the fiber itself scatters.
TEST(ShadeProbe, AOneSidedSkyWithinItsBound) {
  Scene scene = under_sky(half_bright());
  HairMaterial& material = scene.grooms[0].material;
  double worst = 0;
  for (const float beta_m : {0.06f, 0.13f, 0.25f}) {
    material.beta_longitudinal = beta_m;
    const ShadeConstants constants = under_probe(material, scene);
    for (const float sigma_a : {0.02f, 0.3f, 2.f}) {
      ShadeBatch batch = random_batch();
      batch.absorb_r.fill(sigma_a), batch.absorb_g.fill(sigma_a), batch.absorb_b.fill(sigma_a), batch.occlusion.fill(1);
      evaluate_scalar(constants, batch);
      double square = 0, mean = 0, bias = 0, turned = 0;
      for (std::size_t i = 0; i < batch.count; ++i) {
        const SkySums sums = summed_over_sky(material, scene.environment, {batch.tx[i], batch.ty[i], batch.tz[i]},
                                             {batch.ex[i], batch.ey[i], batch.ez[i]}, kernel::v_splat(sigma_a));
        const double error = static_cast<double>(batch.g[i] - sums.facing.y - sums.single.y);
        const double facing = static_cast<double>(sums.facing.y - sums.lambertian.y);
        square += error * error, bias += error, turned += facing * facing, mean += static_cast<double>(sums.single.y);
      }
      const double count = static_cast<double>(batch.count), error = std::sqrt(square / count) / (mean / count);
      EXPECT_LE(error, static_cast<double>(kernel::kGlowMaxRelError)) << beta_m << " " << sigma_a;
      std::printf("half-bright sky, beta_m %.2f, sigma_a %.2f: error %.3f of the mean, bias %+.3f; facing the eye adds %.3f\n",
                  static_cast<double>(beta_m), static_cast<double>(sigma_a), error, bias / mean,
                  std::sqrt(turned / count) / (mean / count));
      worst = std::max(worst, error);
    }
  }
  EXPECT_GT(worst, 0);
}

TEST(ShadeProbe, WideEqualsScalarForEveryModel) {
  for (const auto model : kModels) {
    Scene scene = under_sky(half_bright());
    scene.grooms[0].material.model = model;
    scene.lights = {directional({0.3f, -1, -0.5f}, {3, 3, 2})};
    const LightRig rig = prepare_lights(scene, MeshTracer({}));
    for (const bool dual : {true, false}) expect_wide_equals_scalar(shade_constants(scene.grooms[0].material, dual, rig));
  }
}

// Of the whole stage: strands that no light reaches but the probe's.
TEST(ShadeProbe, LightsWhatIsVisible) {
  const Scene scene = under_sky(nullptr);
  const Radiance r = shade_all(scene, random_gbuffer(scene, 1));
  ASSERT_GT(r.color.size(), 10u);
  for (const Vec3 c : r.color) EXPECT_GT(c.x, 0.2f);
}

TEST(Shade, DirectLightFadesWithTheCrossingsOfTheOpacityMap) {
  // Without multiple scattering a strand too thin to share others with the eye keeps e^−n of the light; n is what crossings_at() says.
  Scene scene = thicket(HairMaterial::Model::kMarschner);
  scene.lights.resize(1), scene.environment.radiance = {0, 0, 0};
  scene.settings.dual_scattering = false;
  const GBuffer g = random_gbuffer(scene, 1);
  const LightRig rig = prepare_lights(scene, MeshTracer({}));
  const CameraView view = make_camera_view(scene.camera, 32, 32);
  const SegmentNumbering numbering = numbering_of(scene);
  scene.grooms[0].width_scale = 1e-6f;
  const Radiance shadowed = shade(scene, view, numbering, g, rig, kMiddle);
  scene.settings.shadows = false;
  const Radiance lit = shade_all(scene, g);
  float deepest = 0;
  for (std::uint32_t p = 0; p < 32 * 32; ++p) {
    const std::uint32_t i = lit.index[p];
    if (i == Radiance::kNone || !(lit.color[i].x > 1e-4f)) continue;
    const SegmentRef s = find_segment(scene, numbering, static_cast<std::uint32_t>(g.sample_keys[p]));
    const float t =
        locate_on_segment(scene, numbering, view, s, static_cast<float>(p % 32) + 0.5f, static_cast<float>(p / 32) + 0.5f);
    const float n = crossings_at(rig.lights[0].opacity, surface_at(scene, numbering, s, t).position);
    EXPECT_NEAR(shadowed.color[i].x / lit.color[i].x, std::exp(-n), 2e-3f) << p;
    deepest = std::max(deepest, n);
  }
  EXPECT_GT(deepest, 1);
}

/// The scene with every strand as a thick hair of so many fibers in a circle `widths` times as wide as a strand.
Scene bundled(Scene scene, float fibers, float widths) {
  const std::size_t points = scene.grooms[0].strands->point_count();
  const float width = scene.grooms[0].strands->width(0);
  ThickSections sections;
  sections.major.assign(points, {0.5f * widths * width, 0, 0}), sections.minor.assign(points, {0, 0.5f * widths * width, 0});
  sections.fibers.assign(points, fibers), sections.diameters.assign(points, width), sections.spreads.assign(points, 0);
  scene.grooms[0].sections = std::make_shared<const ThickSections>(std::move(sections));
  return scene;
}

/// Strands along y at random in a box, under a light that travels along `travels`, without multiple scattering.
Scene parallel_strands(Vec3 travels) {
  std::vector<std::array<Vec3, 2>> lines;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    Rng rng(11, i);
    const float x = 0.2f * rng.uniform() - 0.1f, z = 0.2f * rng.uniform() - 0.1f;
    lines.push_back({Vec3(x, -0.5f, z), Vec3(x, 0.5f, z)});
  }
  Scene scene = scene_of(linear(lines, 3e-4f));
  scene.camera.projection = Camera::Projection::kOrthographic, scene.camera.height = 0.2f;
  scene.settings.dual_scattering = false, scene.settings.opacity_map_size = 256;
  scene.environment.radiance = {0, 0, 0};
  scene.lights = {directional(travels, {1, 1, 1})};
  return scene;
}

/// Share of the light that comes to those of `scene`, wherever they are.
double share_of_light(Scene scene) {
  const GBuffer g = random_gbuffer(scene, 1);
  const auto sum = [&] {
    double total = 0;
    for (const Vec3 c : shade_all(scene, g).color) total += static_cast<double>(c.x);
    return total;
  };
  const double arriving = sum();
  scene.settings.shadows = false;
  return arriving / sum();
}

// What the eye sees is lit from where it stands: nothing is between. A tenth of a radian beside it strands shade as they do from anywhere.
TEST(Shade, LightFromBehindTheEyeMeetsNothing) {
  for (const float fibers : {0.f, 5.f}) {
    const auto share = [&](Vec3 travels) {
      const Scene scene = parallel_strands(travels);
      return share_of_light(fibers > 0 ? bundled(scene, fibers, 30) : scene);
    };
    const double behind = share({0, 0, -1}), beside = share({0.1f, 0, -1}), across = share({1, 0, 0});
    std::printf("share of the light: %.3f from behind the eye, %.3f beside it, %.3f across\n", behind, beside, across);
    EXPECT_GT(behind, 2 * beside) << fibers;
    EXPECT_GT(behind, 0.8) << fibers;
    EXPECT_TRUE(fibers > 0 || std::fabs(beside - across) < 0.15 * across);
  }
}

TEST(Shade, ABundleOfOneFiberIsAFiber) {
  Scene scene = thicket(HairMaterial::Model::kMarschner);
  const GBuffer g = random_gbuffer(scene, 1);
  const Radiance strands = shade_all(scene, g);
  const LightRig rig = prepare_lights(scene, MeshTracer({}));  // the same for both
  const Scene one = bundled(scene, 1, 1);
  const Radiance thick = shade(one, make_camera_view(one.camera, 32, 32), numbering_of(one), g, rig, kMiddle);
  ASSERT_EQ(thick.color.size(), strands.color.size());
  for (std::size_t i = 0; i < strands.color.size(); ++i)
    EXPECT_NEAR(thick.color[i].x, strands.color[i].x, 0.02f * strands.color[i].x) << i;
}

// Alone under a light from behind, dense bundles let less through than loose ones; the setting switches that off.
TEST(Shade, DenseBundlesShadeThemselves) {
  Scene scene = scene_of(linear({{Vec3(0, -0.5f, 0), Vec3(0, 0.5f, 0)}}, 1e-4f));
  scene.lights = {directional({0, 0, 1}, {1, 1, 1})};
  scene.environment.radiance = {0, 0, 0};
  const GBuffer g = random_gbuffer(scene, 1);
  const auto mean = [&](const Scene& s) {
    double sum = 0;
    for (const Vec3 c : shade_all(s, g).color) sum += static_cast<double>(c.x);
    return sum;
  };
  const double loose = mean(bundled(scene, 50, 2000)), dense = mean(bundled(scene, 50, 20));
  EXPECT_LT(dense, 0.6 * loose);
  scene.settings.thick_hairs.scattering = ThickScattering::kFiber;
  EXPECT_NEAR(mean(bundled(scene, 50, 20)), mean(bundled(scene, 50, 2000)), 0.2 * loose);
}

/// Light of fibers that lean about the y axis, one by one, beside one bundle that knows the variance of their directions, from before, aside and behind.
/// `lean` gives the tangent of the angle of a random fiber; fibers count as long as the eye, on the z axis, sees them.
struct LeaningLight {
  double one_by_one, bundle, bundle_without;
};
template <class Lean>
std::vector<LeaningLight> leaning_light(float variance, const Lean& lean) {
  std::vector<LeaningLight> found;
  Scene scene = thicket(HairMaterial::Model::kMarschner);
  scene.environment.radiance = {0, 0, 0}, scene.settings.shadows = false;
  for (const Vec3 travels : {Vec3(0.2f, -0.3f, -1), Vec3(-0.9f, -0.6f, -0.2f), Vec3(0.3f, -0.35f, 1)}) {
    scene.lights = {directional(travels, {1, 1, 1})};
    const LightRig rig = prepare_lights(scene, MeshTracer({}));
    ShadeConstants constants = shade_constants(scene.grooms[0].material, false, rig);
    ShadeBatch batch = random_batch();
    double light = 0, seen = 0;
    constexpr int kBatches = 40;
    for (int b = 0; b < kBatches; ++b) {
      batch.count = ShadeBatch::kSize;
      std::vector<double> shows(ShadeBatch::kSize);
      for (std::uint32_t i = 0; i < ShadeBatch::kSize; ++i) {
        Rng rng(17 + static_cast<std::uint32_t>(b), i);
        const float radius = lean(rng.uniform()), angle = 6.2831853f * rng.uniform();
        const Vec3 tangent = normalize({radius * std::cos(angle), 1, radius * std::sin(angle)});
        batch.tx[i] = tangent.x, batch.ty[i] = tangent.y, batch.tz[i] = tangent.z;
        batch.ex[i] = 0, batch.ey[i] = 0, batch.ez[i] = 1;
        batch.absorb_r[i] = batch.absorb_g[i] = batch.absorb_b[i] = 0.2f;
        shows[i] = static_cast<double>(std::sqrt(1 - tangent.z * tangent.z));
      }
      pad(batch);
      evaluate_scalar(constants, batch);
      for (std::size_t i = 0; i < batch.count; ++i) light += shows[i] * static_cast<double>(batch.r[i]), seen += shows[i];
    }
    const auto upright = [&](float spread) {
      batch.count = 1, batch.tx[0] = 0, batch.ty[0] = 1, batch.tz[0] = 0;
      batch.fibers[0] = 1, batch.lean[0] = spread;
      pad(batch);
      evaluate_scalar(constants, batch);
      return static_cast<double>(batch.r[0]);
    };
    constants.bundled = true;
    found.push_back({light / seen, upright(variance), upright(0)});
  }
  return found;
}

TEST(Shade, LeaningFibersWidenTheLobesOfTheirBundle) {
  constexpr float kLean = 0.15f;  // along both axes, at random
  double most_without = 0;
  for (const LeaningLight& l : leaning_light(kLean * kLean, [](float u) { return kLean * std::sqrt(-2 * std::log(1 - u)); })) {
    EXPECT_NEAR(l.bundle, l.one_by_one, 0.12 * l.one_by_one);
    most_without = std::max(most_without, std::fabs(l.bundle_without / l.one_by_one - 1));
  }
  EXPECT_GT(most_without, 0.4);
}

TEST(Shade, CoilsAreShadedAtPlacesOfTheirCone) {
  constexpr float kSine = 0.8f, kCosine = 0.6f;  // of the angle at which a coil leans, about its line
  for (const LeaningLight& l : leaning_light(0.5f * kSine * kSine, [](float) { return kSine / kCosine; })) {
    EXPECT_NEAR(std::log(l.bundle / l.one_by_one), 0, 0.32);
    EXPECT_GT(std::fabs(std::log(l.bundle_without / l.one_by_one)), 0.95);
  }
}

TEST(Shade, MultipleScatteringBrightensBlondHairInShadow) {
  Scene scene = thicket(HairMaterial::Model::kMarschner);
  scene.grooms[0].material.eumelanin = 0.1f, scene.grooms[0].material.pheomelanin = 0.05f;
  const GBuffer g = random_gbuffer(scene, 1);
  const auto total = [&] {
    double sum = 0;
    for (const Vec3 c : shade_all(scene, g).color) sum += static_cast<double>(c.x);
    return sum;
  };
  const double dual = total();
  scene.settings.dual_scattering = false;
  const double single = total();
  EXPECT_GT(dual, 1.3 * single);
}

TEST(Shade, StrandColorsAreUsedWhereAskedFor) {
  StrandSet set =
      linear({{Vec3(-0.01f, -0.5f, 0), Vec3(-0.01f, 0.5f, 0)}, {Vec3(0.01f, -0.5f, 0), Vec3(0.01f, 0.5f, 0)}}, 1e-3f);
  set.colors = {{0.9f, 0.1f, 0.1f}, {0.1f, 0.1f, 0.9f}};
  Scene scene = scene_of(std::move(set));
  scene.grooms[0].material.color_source = HairMaterial::ColorSource::kStrand;
  scene.lights.push_back(directional({0, 0, -1}, {1, 1, 1}));
  GBuffer g;
  g.width = g.height = 32;
  g.center.resize(32 * 32), g.center.fill(kEmptyPixel);
  g.center[5] = PixelKey{0x3f800000u} << 32, g.center[6] = PixelKey{0x3f800000u} << 32 | 2;
  const CameraView view = make_camera_view(scene.camera, 32, 32);
  const Radiance r = shade(scene, view, numbering_of(scene), g, prepare_lights(scene, MeshTracer({})), kMiddle);
  ASSERT_EQ(r.color.size(), 2u);
  EXPECT_GT(r.color[0].x, 1.5f * r.color[0].z);
  EXPECT_GT(r.color[1].z, 1.5f * r.color[1].x);
}

TEST(Shade, NothingVisibleAndNoLights) {
  Scene scene = thicket(HairMaterial::Model::kMarschner);
  GBuffer g = random_gbuffer(scene, 2);
  scene.lights.clear(), scene.environment.radiance = {0, 0, 0};
  for (const Vec3 c : shade_all(scene, g).color) EXPECT_EQ(c, Vec3(0, 0, 0));
  g.sample_keys.fill(kEmptyPixel);
  const Radiance none = shade_all(scene, g);
  EXPECT_TRUE(none.color.empty());
  for (const std::uint32_t i : none.index) EXPECT_EQ(i, Radiance::kNone);
}

TEST(VisibleList, OneEntryPerSegmentAndPixel) {
  const auto key = [](std::uint32_t depth, std::uint32_t id) { return PixelKey{depth} << 32 | id; };
  const std::vector<PixelKey> keys = {key(5, 1),   key(4, 2),   key(3, 1),   kEmptyPixel,  // pixel 0
                                      kEmptyPixel, kEmptyPixel, kEmptyPixel, kEmptyPixel,
                                      key(1, 1),   key(1, 1),   key(1, 1),   key(2, 1)};
  const VisibleList list = list_visible(keys, 4);
  const std::vector<std::uint32_t> first(list.first.begin(), list.first.end());
  EXPECT_EQ(first, (std::vector<std::uint32_t>{0, 1, 8}));
  const std::vector<std::uint32_t> index(list.index.begin(), list.index.end());
  const std::uint32_t none = Radiance::kNone;
  EXPECT_EQ(index, (std::vector<std::uint32_t>{0, 1, 0, none, none, none, none, none, 2, 2, 2, 2}));
}

}  // namespace
}  // namespace pelage
