// What is seen, from where, in which light: the one description that every renderer of Pelage reads.
#pragma once

#include <pelage/hair_mesh.h>
#include <pelage/image.h>
#include <pelage/strand_set.h>
#include <pelage/triangle_mesh.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pelage {

/// Two eyes side by side that look the same way, in place of one. Of a point at depth z the left eye's picture shows
/// separation·(1/z − 1/convergence)·(focal length in pixels) pixels farther to the right than the right eye's.
struct Stereo {
  float separation = 0.063f;  ///< metres between the eyes, > 0
  float convergence = 0;  ///< metres before the eyes: what is there lies in the plane of the picture; 0: as far as the target
};

struct Camera {
  enum class Projection { kPerspective, kOrthographic };
  Projection projection = Projection::kPerspective;
  Vec3 eye{0, 0, 1};
  Vec3 target{0, 0, 0};
  Vec3 up{0, 1, 0};
  float fov_y = 0.5f;         ///< radians, full vertical angle of the perspective camera, (0, π)
  float height = 0.5f;        ///< metres, full vertical extent of the orthographic camera, > 0
  float near_plane = 0.001f;  ///< metres in front of the eye, > 0; nearer things are clipped
  float shift_x = 0;  ///< lens shift, −10…10: the picture shows what lies to the right by this share of its height …
  float shift_y = 0;  ///< … and above by this one
  std::optional<Stereo> stereo;  ///< the camera stands for two eyes: eyes()
};

/// The cameras that see what `camera` sees: itself, or the left and the right eye, which converge by lens shift and not by turning.
/// Throws Error("camera", …) where a stereo camera is orthographic or its distances are out of range.
std::vector<Camera> eyes(const Camera& camera);

struct Light {
  enum class Type { kPoint, kSpot, kDirectional };
  Type type = Type::kDirectional;
  std::string name;
  Vec3 position{0, 0, 0};    ///< point and spot: metres
  Vec3 direction{0, -1, 0};  ///< spot and directional: where the light travels; unit length
  Vec3 intensity{1, 1, 1};   ///< point and spot: radiant intensity, W/sr; directional: irradiance, W/m²; RGB
  float inner_angle = 0.3f;  ///< spot: radians from the axis up to which it is full
  float outer_angle = 0.4f;  ///< spot: radians from the axis from which it is dark; > inner_angle
  bool casts_shadow = true;
};

/// Light from far away: a constant, times a latitude-longitude map where one is given.
struct Environment {
  Vec3 radiance{0, 0, 0};            ///< W/(m²·sr), RGB; multiplies the map where there is one
  std::shared_ptr<const Image> map;  ///< RGB, row 0 is straight up, the middle column looks along −Z; may be null
  float rotation = 0;                ///< radians about +Y, counter-clockwise from above
  bool visible = false;              ///< shown behind the scene; otherwise the background colour is
};

/// A lobe of Sadeghi's model, as an artist sets it.
struct ArtistLobe {
  float intensity;      ///< share of the light that it scatters, 0…1; where all lobes exceed 1, all are scaled down
  Vec3 color{1, 1, 1};  ///< 0…1; multiplies what the hair's absorption leaves of TT (one crossing) and TRT (two)
  float shift;          ///< radians of θ_h = (θ_i + θ_o)/2, positive toward the tip
  float width;          ///< radians, standard deviation of θ_h
};

/// Sadeghi's model: every lobe has handles of its own, and they do not act on each other.
struct ArtistLobes {
  ArtistLobe r{0.08f, {1, 1, 1}, -3.f * 3.14159265f / 180, 7.5f * 3.14159265f / 180};
  ArtistLobe tt{0.55f, {1, 1, 1}, 1.5f * 3.14159265f / 180, 3.75f * 3.14159265f / 180};
  ArtistLobe trt{0.25f, {1, 1, 1}, 4.5f * 3.14159265f / 180, 15.f * 3.14159265f / 180};  ///< without its glints
  float tt_azimuthal_width = 15.f * 3.14159265f / 180;                                   ///< radians, standard deviation
  float glint_intensity = 0.1f;                  ///< of both glints together; color, shift and width are TRT's
  float glint_angle = 35.f * 3.14159265f / 180;  ///< radians of azimuth from the light to either glint
  float glint_width = 8.f * 3.14159265f / 180;   ///< radians, azimuthal standard deviation
};

/// Single-fibre scattering and its colour.
struct HairMaterial {
  enum class Model { kKajiyaKay, kMarschner, kZhu, kChiang, kSadeghi, kPelekis };
  enum class ColorSource { kMelanin, kRgb, kStrand };
  Model model = Model::kMarschner;
  ColorSource color_source = ColorSource::kMelanin;
  float eumelanin = 0.7f;          ///< concentration, ≥ 0; 0.08 blond, 0.28 light brown, 0.7 brown, 6 black
  float pheomelanin = 0.2f;        ///< concentration, ≥ 0; red hair 1 and more
  Vec3 color{0.3f, 0.15f, 0.07f};  ///< linear colour of a dense tuft, 0…1, for kRgb (and where strands have none)
  float eta = 1.55f;               ///< index of refraction, > 1
  float beta_longitudinal = 7.5f * 3.14159265f / 180;  ///< radians, standard deviation of M_R; TT half, TRT twice of it
  float beta_azimuthal = 15.f * 3.14159265f / 180;     ///< radians, standard deviation of N_TT
  float cuticle_tilt = 3.f * 3.14159265f / 180;  ///< radians, α ≥ 0; R shifts by −2α in θ_i + θ_o terms toward the root
  float specular_gain = 1;                       ///< multiplies R; 1 is physical
  ArtistLobes artist;                            ///< of kSadeghi, which has no use for eta, tilt, gain and beta_longitudinal
};

struct LodHierarchy;  // <pelage/lod.h>

/// What pieces of thick hairs stand for, at each point of their strands: a bundle of fibers in an elliptical cross-section
/// (Huang 2025, section 4; references.bib: Huang2025LevelOfDetail). Metres, in the space of the strands.
struct ThickSections {
  std::vector<Vec3> major, minor;  ///< [points] semi-axes r_A and r_B, across the hair
  std::vector<float> fibers;       ///< [points] n_total, > 0: hairs that a line across the hair would meet in the whole section
  std::vector<float> diameters;    ///< [points] of one fiber, ≥ 0
  std::vector<float> spreads;      ///< [points] radians², variance of the fibers' directions about the hair's, along each axis
  std::vector<float>
      twists;  ///< [0] or [points] radians a metre by which the fibers turn about the hair's middle, right-handed
               ///< toward the tip: that part of `spreads` is no chance; none: 0
  std::vector<std::uint8_t> levels;  ///< [strands] of the chain that each shows, 0 the coarsest
};

/// Spans first_span … first_span + spans − 1 of a strand.
struct StrandPart {
  std::uint32_t strand = 0, first_span = 0, spans = 0;
  bool operator==(const StrandPart&) const = default;
};

/// A groom: strands, or a hair mesh that they are made from.
struct GroomInstance {
  std::string name;
  std::shared_ptr<const StrandSet> strands;   ///< null where expand_hair_meshes() has not been there yet
  std::shared_ptr<const HairMesh> hair_mesh;  ///< or null. Method::kSwr draws it as it is, everything else its strands
  std::shared_ptr<const LodHierarchy> lod;  ///< or null: thick hairs of `strands`, drawn where clusters are small on the screen
  /// Of `strands`, what is drawn, ascending and none twice; null: all. RenderSettings::thick_hairs sets it where there is `lod`.
  std::shared_ptr<const std::vector<StrandPart>> only;
  /// Of pieces of thick hairs: their cross-sections; the widths of `strands` are then what fibers cover, seen from the eye. Else null.
  std::shared_ptr<const ThickSections> sections;
  /// Of levels of detail that blend, [points] of `strands`: which share of them is drawn there, 0…1; the other level has the rest. The widths are narrowed by it,
  /// `sections` are whole. Null: all of them. Not to be traced.
  std::shared_ptr<const std::vector<float>> shares;
  float lod_lambda = 1.4f;  ///< λ of Lipp 2026, eq. 2, of a hair mesh: 0.01…1000, more keeps more strands
  HairMaterial material;
  std::shared_ptr<const Image> color_map;    ///< of a hair mesh: linear RGB over the groom's u (x) and v (y), instead of the
                                             ///< material's color; may be null
  std::shared_ptr<const Image> color_along;  ///< of a hair mesh: the same over w (x), times `color_map` where both are given
  /// Of a hair mesh: what multiplies both roughnesses of the material, and its cuticle_tilt, over u and v, and over w; each in
  /// the first channel, 0…16; may be null.
  std::shared_ptr<const Image> roughness_map, roughness_along, tilt_map, tilt_along;
  Affine transform;       ///< object to world; similarity (rotation, translation, one scale)
  float width_scale = 1;  ///< multiplies every width
};

struct MeshInstance {
  std::string name;
  std::shared_ptr<const TriangleMesh> mesh;
  std::shared_ptr<const Image> texture;  ///< RGB, linear; may be null
  Vec3 color{0.45f, 0.3f, 0.24f};        ///< linear diffuse reflectance, multiplies the texture
  float specular = 0.04f;                ///< reflectance at normal incidence
  float roughness = 0.5f;                ///< GGX α, (0, 1]
  Affine transform;                      ///< object to world
};

/// What the picture shows.
enum class View {
  kBeauty,
  kStrandId,
  kU,
  kTangent,
  kDepth,
  kCoverage,
  kOverdraw,
  kAlbedo,
  kMotion,
  kLinked,     ///< pixels that strand linking starts from (1) and those that it has filled (2)
  kLinkAlpha,  ///< opacity of hair after linking and alpha fix, before the filter
  kLod,        ///< level of thick hairs that is drawn, 0 the coarsest; -1: strands themselves
};

/// Where a pixel's opacity comes from.
enum class AlphaSource {
  kSamples,   ///< share of covered samples
  kAnalytic,  ///< exact area of the bands inside the pixel
};

enum class ToneMap { kAces, kNone };

/// How a picture is anti-aliased.
enum class Method {
  kMsaa,     ///< `samples` places a pixel, all in one frame; those that see the same segment share one shade
  kSsaa,     ///< `samples` frames of one sample each, every one shaded where it is; the reference
  kTaa,      ///< frames of one sample each in turn, every one blended into those before; see `frames`
  kFxaa,     ///< one sample in the middle of the pixel, then FXAA 3.11
  kSmaa,     ///< one sample in the middle of the pixel, then SMAA 1x
  kLink,     ///< one sample a pixel, then strand linking and its filter (Huang 2025); see `link`
  kLinkTaa,  ///< kTaa of frames that are made by kLink
  kOidn,     ///< one sample in the middle of the pixel, then Open Image Denoise, in builds that have it
  kSwr,      ///< deferred software rasterization of hair meshes (Lipp 2026), 1, 2, 4 or 8 samples; see `swr`
};

/// Where the opacity of hair that strand linking has found comes from.
enum class LinkAlpha {
  kCount,     ///< hit over hit and filled pixels of each segment; Huang 2025, eq. 8
  kCoverage,  ///< exact area of the strands, by another layer of raster: better, and about five times as long as raster
  kNone,      ///< none: linked strands are as opaque as others, to see what alpha fix is worth
};

/// How the environment lights strands. Opaque surfaces have its irradiance either way.
enum class EnvironmentLighting {
  kPieces,  ///< as 16 directional lights, each with its own opacity map
  kProbe,   ///< by prefiltered maps and spherical harmonics, without shadows but those of baked occlusion
};

/// Strand linking and its filter, of Method::kLink: the symbols of Huang 2025 (docs/methods.md).
struct LinkSettings {
  bool link = true;           ///< false: only the filter
  float alignment = 0.5f;     ///< ε_align of eq. 5, 0…1: how well a strand has to fit an empty pixel
  float sigma = 1.41421356f;  ///< σ of eq. 4, pixels; below 1.2 no diagonal neighbor ever reaches an alignment of 0.5
  float depth_sigma = 0;  ///< > 0: strands that are this share of the distance behind the nearest count less. 0: as published
  LinkAlpha alpha = LinkAlpha::kCount;
  bool filter = true;  ///< false: only links and alpha fix
  /// k of eq. 13: half of the kernel's major axis over the size of the hair; published: 0.01. 0, the default: kernels of
  /// `kernel_radius` that adapt to the hair of each pixel (docs/derivations/linking.md).
  float kernel_size = 0;
  float kernel_radius =
      9;  ///< half of the major axis, pixels, for thin hair of one direction; 1 at least; read where kernel_size is 0
  float aspect = 0.15f;  ///< ρ, its minor over its major axis, 0…1
  float falloff = 0.5f;  ///< σ∥ over the one and σ⊥ over the other half axis (Lipp 2026, eq. 9); INFINITY: as published in 2025
  float sigma_distance = INFINITY;  ///< σ_d of eq. 11, in units of r; INFINITY: all distances within the kernel count alike
  float sigma_angle = INFINITY;     ///< σ_θ of eq. 11, radians
  float sigma_color = INFINITY;     ///< σ_c of eq. 11, linear radiance
};

/// Where the opacity of a pixel of method swr comes from.
enum class SwrAlpha {
  kKernel,    ///< center hits over all pixels under the kernel; of lone strands as kRatio
  kRatio,     ///< center hits over conservative hits along the strand; Lipp 2026, §3.3.3
  kCoverage,  ///< exact area of the strands, by another layer of raster
};

/// Deferred software rasterization of hair meshes, of Method::kSwr: the symbols of Lipp 2026 (docs/methods.md).
struct SwrSettings {
  bool lod = true;                ///< fewer strands and points of bundles that are small on the screen: eq. 1 to 5
  int points = 127;               ///< C_max of eq. 4: control points of a strand at full detail, 3…127
  bool thicken = true;            ///< strands that stay take over the width of those that are left out; false: as published
  bool depth_correction = true;   ///< eq. 8: of light that comes through strands that were left out
  bool filter = true;             ///< reconnection filter, of pictures of one sample; false: samples as they are
  int radius = 5;                 ///< r of §3.3.1, pixels, 1…15
  float s_parallel = 0.36f;       ///< s∥: σ∥ = r·s∥
  float s_perpendicular = 0.15f;  ///< s⊥: σ⊥ = r·s⊥
  float sigma_color = 0.9f;       ///< σ_c of eq. 10, linear radiance
  float depth_tolerance = 0.05f;  ///< neighbors farther off than this share of the hair's depth do not count
  float connect_depth = 0.05f;    ///< share of the hair's depth from which a strand in front of the pixel's own is another one
  float strip = 0.5f;             ///< w_strip, pixels: half the width of the strip in which hits are counted
  SwrAlpha alpha = SwrAlpha::kKernel;
  bool occlusion = true;  ///< baked occlusion dims the probe's light; false: strands see the whole sky
};

/// What thick hairs scatter.
enum class ThickScattering {
  kAggregate,  ///< as the bundle that they stand for: fibers shade each other in it (Huang 2025, section 4)
  kFiber,      ///< as one fiber that is as wide
};

/// What stands for clusters that are small on the screen.
enum class LodShape {
  kThickHairs,  ///< one hair of elliptical cross-section for each cluster (Huang 2025)
  kStrands,     ///< as many of its strands, wide enough for all of them (Cook 2007)
  kCards,       ///< flat strips that strands are projected onto, cut out by alpha
};

/// Level of detail of grooms with thick hairs (Huang 2025; docs/lod.md), of any method that draws strands.
struct ThickHairSettings {
  bool on = true;    ///< false: all strands, however small they are on the screen
  float pixels = 2;  ///< ε_w of eq. 16: how wide thick hairs may be on the screen, 0.1…64
  float error =
      0;  ///< > 0: instead of `pixels`, how much FLIP beside all strands is predicted of thick hairs, 0…0.2; not for cards (docs/lod.md)
  /// β: a hair that is wider than (1 − β) of what it may be fades out while its children fade in, 0…0.9; 0: it is replaced at once. Of thick hairs, not of one `level`
  float blend = 0;
  LodShape shape = LodShape::kThickHairs;
  int level = -1;  ///< ≥ 0: this level everywhere (0 is the coarsest, finest where there are fewer); -1: by `pixels` or `error`
  ThickScattering scattering = ThickScattering::kAggregate;
};

struct RenderSettings {
  int width = 1024, height = 1024;  ///< pixels, 1…16384
  Method method = Method::kMsaa;
  int samples =
      8;  ///< per pixel; kMsaa: 1, 2, 4, 8 or 16; kSsaa: 1…4096; kLink, kLinkTaa: 1, 4, 9 or 16; no other method reads it
  int frames = 16;  ///< kTaa and kLinkTaa: frames that a still camera takes for one picture, 1…4096
  AlphaSource alpha = AlphaSource::kSamples;
  LinkSettings link;
  SwrSettings swr;
  ThickHairSettings thick_hairs;
  View view = View::kBeauty;
  float exposure = 0;  ///< stops
  ToneMap tone_map = ToneMap::kAces;
  Vec3 background{0.18f, 0.19f, 0.21f};  ///< linear, where nothing is hit and the environment is hidden
  bool transparent_background = false;   ///< keep alpha instead of the background
  int subdivisions = 0;                  ///< segments per span; 0 chooses from the projected curvature
  bool shadows = true;
  std::optional<EnvironmentLighting> environment_lighting;  ///< none: what suits the method; see environment_lighting()
  bool dual_scattering = true;                              ///< multiple scattering after Zinke 2008
  int opacity_map_size = 1024;                              ///< texels a side, 64…4096
};

struct Scene {
  Camera camera;
  std::optional<Camera> previous_camera;  ///< where it was a frame ago, for motion vectors; none: it stood still
  std::vector<Light> lights;
  Environment environment;
  std::vector<GroomInstance> grooms;
  std::vector<MeshInstance> meshes;
  RenderSettings settings;
};

/// Gives every groom that has a hair mesh and no strands those of the mesh at full detail. render(), trace() and render_gbuffer()
/// do it by themselves, but for Method::kSwr.
void expand_hair_meshes(Scene& scene, const Progress& progress = {});
/// Whether expand_hair_meshes() would do something.
bool has_unmade_strands(const Scene& scene);

/// How the environment lights the strands of a picture with these settings.
EnvironmentLighting environment_lighting(const RenderSettings& settings);

/// Box of all grooms and meshes in world space.
Bounds bounds(const Scene& scene);

/// Camera, three-point light and environment for whatever stands in the scene: what `pelage render FILE` uses.
/// Looks at the grooms (at the meshes where there are none) slightly from the front left, +Z being the front.
void add_default_camera(Scene& scene);
void add_default_lights(Scene& scene);

}  // namespace pelage
