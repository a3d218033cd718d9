// The keys of a scene file: names, units, ranges and what they set. Lengths in metres, angles in degrees.
#include "io/scene_tables.h"

#include <cmath>
#include <utility>

#include "frame/sample_positions.h"
#include "kernel/scalar.h"

namespace pelage::io {
namespace {

constexpr double kFar = 1e6;  // metres
constexpr double kBright = 1e9;
constexpr double kDegree = 3.14159265358979 / 180;

// A field of an object that may be absent as a whole.
template <class T, class U>
Field<T> optional_object_field(std::string key, const char* about, std::optional<U> T::*member, const Fields<U>& fields) {
  Schema schema = object_schema(fields);
  schema["description"] = about;
  return {std::move(key), std::move(schema),
          [=, &fields](const JsonValue& v, T& out) { read_object(v, fields, (out.*member).emplace()); }};
}

// The same field for a part of a larger struct.
template <class T, class U>
Field<T> nested(U T::*part, Field<U> field) {
  return {std::move(field.key), std::move(field.schema),
          [part, read = std::move(field.read)](const JsonValue& v, T& out) { read(v, out.*part); }, field.is_required};
}

const Fields<Stereo>& stereo_fields() {
  static const Fields<Stereo> table{
      number_field("separation", "Meters between the eyes; those of people are 0.063 apart", &Stereo::separation, 1e-6, kFar),
      number_field("convergence", "Meters before the eyes to what lies in the plane of the picture; 0: to the target",
                   &Stereo::convergence, 0, kFar),
  };
  return table;
}

const Fields<Camera>& camera_fields() {
  static const Names<Camera::Projection> projections{{"perspective", Camera::Projection::kPerspective},
                                                     {"orthographic", Camera::Projection::kOrthographic}};
  static const Fields<Camera> table{
      choice_field("projection", "How the camera projects", &Camera::projection, projections),
      vector_field("eye", "Where the camera stands, meters", &Camera::eye, -kFar, kFar).required(),
      vector_field("target", "What it looks at, meters", &Camera::target, -kFar, kFar).required(),
      vector_field("up", "Which way is up in the picture", &Camera::up, -kFar, kFar),
      number_field("fov", "Full vertical angle of the perspective camera, degrees", &Camera::fov_y, 0.01, 179, kDegree),
      number_field("height", "Full vertical extent of the orthographic camera, meters", &Camera::height, 1e-6, kFar),
      number_field("near", "Nearer things are clipped, meters", &Camera::near_plane, 1e-6, kFar),
      number_field("shift_x", "Lens shift: heights of the picture by which it shows what lies to the right", &Camera::shift_x,
                   -10, 10),
      number_field("shift_y", "Lens shift: heights of the picture by which it shows what lies above", &Camera::shift_y, -10,
                   10),
      optional_object_field("stereo", "Two eyes in place of one: their pictures side by side", &Camera::stereo,
                            stereo_fields()),
  };
  return table;
}

const Fields<Light>& light_fields() {
  static const Names<Light::Type> types{
      {"point", Light::Type::kPoint}, {"spot", Light::Type::kSpot}, {"directional", Light::Type::kDirectional}};
  static const Fields<Light> table{
      choice_field("type", "Kind of light", &Light::type, types).required(),
      text_field("name", "For people", &Light::name),
      vector_field("position", "Point and spot lights: meters", &Light::position, -kFar, kFar),
      vector_field("direction", "Spot and directional lights: where the light travels; any length but zero", &Light::direction,
                   -kFar, kFar),
      vector_field("intensity", "RGB; point and spot: W/sr; directional: irradiance, W/m²", &Light::intensity, 0, kBright),
      number_field("inner_angle", "Spot: degrees from the axis up to which it is full", &Light::inner_angle, 0, 89, kDegree),
      number_field("outer_angle", "Spot: degrees from the axis from which it is dark", &Light::outer_angle, 0.01, 89.9,
                   kDegree),
      boolean_field("casts_shadow", "Whether hair and meshes shade this light", &Light::casts_shadow),
  };
  return table;
}

const Fields<EnvironmentText>& environment_fields() {
  using E = Environment;
  constexpr auto part = &EnvironmentText::environment;
  static const Fields<EnvironmentText> table{
      nested(part, vector_field("radiance", "RGB, W/(m²·sr); multiplies the map where there is one", &E::radiance, 0, kBright)),
      text_field("map", "Latitude-longitude image file, relative to the scene file; top row up, middle column −Z",
                 &EnvironmentText::map),
      nested(part,
             number_field("rotation", "Degrees about +Y, counter-clockwise from above", &E::rotation, -3600, 3600, kDegree)),
      nested(part, boolean_field("visible", "Shown behind the scene instead of the background color", &E::visible)),
  };
  return table;
}

const Fields<TransformText>& transform_fields() {
  static const Fields<TransformText> table{
      vector_field("translate", "Meters, after rotation and scale", &TransformText::translate, -kFar, kFar),
      vector_field("rotate", "Degrees about X, then Y, then Z", &TransformText::rotate, -3600, 3600),
      number_field("scale", "One factor for all axes", &TransformText::scale, 1e-9, 1e9),
  };
  return table;
}

const Names<UpAxis> kUpAxes{{"auto", UpAxis::kAuto}, {"y", UpAxis::kY}, {"z", UpAxis::kZ}};

const Fields<MeshText>& mesh_fields() {
  using M = MeshInstance;
  constexpr auto part = &MeshText::instance;
  static const Names<UpAxis> up_axes(kUpAxes.begin() + 1, kUpAxes.end());
  static const Fields<MeshText> table{
      nested(part, text_field("name", "By which grooms may refer to it", &M::name)),
      text_field("file", "OBJ, PLY or glb, relative to the scene file", &MeshText::file),
      text_field("shape", "Made by code instead of a file: \"mannequin\"", &MeshText::shape),
      number_field("scale", "Meters per unit of the file", &MeshText::scale, 1e-9, 1e9),
      choice_field("up", "Which axis of the file points up", &MeshText::up, up_axes),
      text_field("texture", "Color image, relative to the scene file; multiplies the color", &MeshText::texture),
      nested(part, vector_field("color", "Linear diffuse reflectance", &M::color, 0, 1)),
      nested(part, number_field("specular", "Reflectance at normal incidence", &M::specular, 0, 1)),
      nested(part, number_field("roughness", "GGX α", &M::roughness, 0.001, 1)),
      object_field("transform", "Object to world", &MeshText::transform, transform_fields()),
  };
  return table;
}

const Fields<GrowText>& grow_fields() {
  using G = GrowSettings;
  constexpr auto part = &GrowText::settings;
  static const Fields<GrowText> table{
      // First in the table: sets the defaults that the other keys change.
      {"style",
       {{"description", "Chooses the defaults of the other keys"}, {"enum", hair_style_names()}},
       [](const JsonValue& v, GrowText& out) {
         choice_index(v, hair_style_names());
         out.settings = grow_defaults(hair_style_from_name(v.text()));
       },
       true},
      text_field("surface", "\"mannequin\", or the name of a mesh of the scene", &GrowText::surface),
      nested(part, integer_field("seed", "Another seed, another head of hair", &G::seed, 0, INT64_MAX)),
      nested(part, integer_field("strands", "Number of strands", &G::strands, 1, 1000000)),
      nested(part, integer_field("points", "Control points per strand", &G::points, 4, 1024)),
      nested(part, number_field("length", "Mean length of a strand, meters", &G::length, 1e-4, 10)),
      nested(part, number_field("length_variation", "Standard deviation as a share of the length", &G::length_variation, 0, 1)),
      nested(part, number_field("width", "Diameter at the root, meters", &G::width, 1e-7, 0.1)),
      nested(part, number_field("width_variation", "Standard deviation as a share of the width", &G::width_variation, 0, 1)),
      nested(part, number_field("taper", "Share of the width that is gone at the tip", &G::taper, 0, 1)),
      nested(part, number_field("curl_radius", "Mean radius of curls or amplitude of waves, meters", &G::curl_radius, 0, 1)),
      nested(part,
             number_field("curl_pitch", "Mean distance along a lock in which it turns once, meters", &G::curl_pitch, 1e-4, 10)),
      nested(part, integer_field("clumps", "Number of clumps; 0 none", &G::clumps, 0, 1000000)),
      nested(part, number_field("clump_tightness", "0 none … 1 tips meet", &G::clump_tightness, 0, 1)),
      nested(part, number_field("frizz", "Small-scale noise", &G::frizz, 0, 1)),
      nested(part, number_field("flyaways", "Share of strands that leave their clump", &G::flyaways, 0, 1)),
      nested(part, number_field("gravity", "0 stands, 1 hangs", &G::gravity, 0, 1)),
      nested(part, number_field("volume", "How far hair of the crown piles up, meters", &G::volume, 0, 0.5)),
      nested(part, number_field("parting", "Meters left of the middle of the mannequin's head", &G::parting, -0.05, 0.05)),
      nested(part, number_field("undercoat", "Coat: share of short wool between the guard hairs", &G::undercoat, 0, 1)),
  };
  return table;
}

const Fields<HairMeshSettings>& hair_mesh_fields() {
  using H = HairMeshSettings;
  static const Fields<H> table{
      Field<H>{"hair_mesh",
               {{"description", "A head of hair as a hair mesh, on the mannequin"}, {"enum", hair_mesh_style_names()}},
               [](const JsonValue& v, H& out) {
                 if (!hair_mesh_style_names().empty()) choice_index(v, hair_mesh_style_names());
                 out.style = hair_mesh_style_from_name(v.text());  // in a build without them says that there are none
               }}
          .required(),
      integer_field("seed", "Another seed, another head of hair", &H::seed, 0, UINT32_MAX),
      integer_field("strands", "Number of strands at full detail", &H::strands, 1000, 1000000),
      number_field("width", "Diameter at the root, meters", &H::width, 0, 0.1),
      number_field("length_scale", "Length as a share of the style's own", &H::length, 0.5, 1.5),
      number_field("parting", "Meters left of the middle of the mannequin's head", &H::parting, -0.05, 0.05),
      boolean_field("occlusion", "Whether ambient occlusion is baked into it", &H::occlusion),
  };
  return table;
}

// Which of the two things that `grow` makes is meant; throws Error where neither or both are.
bool makes_hair_mesh(const JsonValue& v) {
  check_is_object(v);
  const bool strands = v.node().contains("style"), hair_mesh = v.node().contains("hair_mesh");
  if (strands != hair_mesh) return hair_mesh;
  std::vector<std::string> known;
  for (const auto& field : grow_fields()) known.push_back(field.key);
  for (const auto& field : hair_mesh_fields()) known.push_back(field.key);
  check_keys(v, known, {});  // a key that is nearly right is worth more than what follows
  v.fail(strands ? "both `style` and `hair_mesh`" : "neither `style` nor `hair_mesh`", "give exactly one of them");
}

Field<GroomText> grow_field() {
  Schema schema{{"description", "Made from a seed instead of a file: strands of a style, or a hair mesh"}};
  schema["oneOf"] = {object_schema(grow_fields()), object_schema(hair_mesh_fields())};
  return {"grow", std::move(schema), [](const JsonValue& v, GroomText& out) {
            if (makes_hair_mesh(v)) read_object(v, hair_mesh_fields(), out.hair_mesh.emplace());
            else read_object(v, grow_fields(), out.grow.emplace());
          }};
}

const Fields<ArtistLobe>& artist_lobe_fields() {
  using L = ArtistLobe;
  static const Fields<L> table{
      number_field("intensity", "Share of the light that the lobe scatters", &L::intensity, 0, 1),
      vector_field("color", "Linear; multiplies what the hair's absorption leaves of the light", &L::color, 0, 1),
      number_field("shift", "Degrees, positive toward the tip", &L::shift, -45, 45, kDegree),
      number_field("width", "Degrees, standard deviation", &L::width, 0.5, 60, kDegree),
  };
  return table;
}

const Fields<ArtistLobes>& artist_fields() {
  using A = ArtistLobes;
  static const Fields<A> table{
      object_field("r", "The primary highlight", &A::r, artist_lobe_fields()),
      object_field("tt", "Light that comes through", &A::tt, artist_lobe_fields()),
      object_field("trt", "The secondary highlight without its glints", &A::trt, artist_lobe_fields()),
      number_field("tt_azimuthal_width", "Degrees, standard deviation of TT around the strand", &A::tt_azimuthal_width, 0.5, 90,
                   kDegree),
      number_field("glint_intensity", "Share of the light that both glints scatter", &A::glint_intensity, 0, 1),
      number_field("glint_angle", "Degrees around the strand from the light to either glint", &A::glint_angle, 0, 90, kDegree),
      number_field("glint_width", "Degrees, standard deviation of a glint around the strand", &A::glint_width, 0.5, 90,
                   kDegree),
  };
  return table;
}

// One of Chiang's roughnesses as the standard deviation that it means.
Field<HairMaterial> roughness_field(const char* key, const char* about, float HairMaterial::*member,
                                    float (*deviation)(float)) {
  return {key,
          {{"description", about}, {"type", "number"}, {"minimum", 0.01}, {"maximum", 1.0}},
          [=](const JsonValue& v, HairMaterial& out) { out.*member = deviation(static_cast<float>(v.number(0.01, 1))); }};
}

const Fields<HairMaterial>& material_fields() {
  using M = HairMaterial;
  static const Names<M::Model> models{
      {"kajiya-kay", M::Model::kKajiyaKay}, {"marschner", M::Model::kMarschner}, {"zhu", M::Model::kZhu},
      {"chiang", M::Model::kChiang},        {"sadeghi", M::Model::kSadeghi},     {"pelekis", M::Model::kPelekis}};
  static const Names<M::ColorSource> sources{
      {"melanin", M::ColorSource::kMelanin}, {"rgb", M::ColorSource::kRgb}, {"strand", M::ColorSource::kStrand}};
  Field<M> color = vector_field("color", "Linear color of a dense tuft; sets color_source to rgb", &M::color, 0, 1);
  color.read = [read = color.read](const JsonValue& v, M& out) {
    read(v, out);
    out.color_source = M::ColorSource::kRgb;
  };
  static const Fields<M> table{
      choice_field("model", "Single-fiber scattering", &M::model, models),
      std::move(color),
      choice_field("color_source", "Where the color of the hair comes from", &M::color_source, sources),
      number_field("eumelanin", "Concentration; 0.08 blond, 0.28 light brown, 0.7 brown, 6 black", &M::eumelanin, 0, 100),
      number_field("pheomelanin", "Concentration; red hair 1 and more", &M::pheomelanin, 0, 100),
      number_field("eta", "Index of refraction", &M::eta, 1.01, 3),
      number_field("beta_longitudinal", "Degrees, standard deviation of the R lobe", &M::beta_longitudinal, 0.5, 60, kDegree),
      number_field("beta_azimuthal", "Degrees, standard deviation of the TT lobe", &M::beta_azimuthal, 0.5, 90, kDegree),
      roughness_field("beta_m", "Chiang's longitudinal roughness, 0 to 1; sets beta_longitudinal", &M::beta_longitudinal,
                      kernel::scatter_chiang_beta_m),
      roughness_field("beta_n", "Chiang's azimuthal roughness, 0 to 1; sets beta_azimuthal", &M::beta_azimuthal,
                      kernel::scatter_chiang_beta_n),
      number_field("cuticle_tilt", "Degrees", &M::cuticle_tilt, 0, 15, kDegree),
      number_field("specular_gain", "Multiplies the R lobe; 1 is physical", &M::specular_gain, 0, 100),
      object_field("artist", "Lobes of the model sadeghi", &M::artist, artist_fields()),
  };
  return table;
}

const Fields<GroomText>& groom_fields() {
  using G = GroomInstance;
  constexpr auto part = &GroomText::instance;
  static const Fields<GroomText> table{
      nested(part, text_field("name", "For people", &G::name)),
      text_field("file", "Groom file, relative to the scene file", &GroomText::file),
      grow_field(),
      nested(&GroomText::import,
             number_field("scale", "Meters per unit of the file; guessed without it", &ImportOptions::scale, 1e-9, 1e9)),
      nested(&GroomText::import, choice_field("up", "Which axis of the file points up", &ImportOptions::up, kUpAxes)),
      nested(&GroomText::import,
             number_field("default_width", "Meters, for files without widths", &ImportOptions::default_width, 1e-7, 0.1)),
      nested(part, object_field("material", "How a strand scatters light", &G::material, material_fields())),
      object_field("transform", "Object to world", &GroomText::transform, transform_fields()),
      nested(part, number_field("width_scale", "Multiplies every width", &G::width_scale, 1e-6, 1e6)),
      nested(part, number_field("lod_lambda", "Of a hair mesh: more keeps more strands far away", &G::lod_lambda, 0.01, 1000)),
      text_field("color_map", "Of a hair mesh: image of its color over u and v, relative to the scene file",
                 &GroomText::color_map),
      text_field("color_along", "Of a hair mesh: image of its color from root to tip, in its first row",
                 &GroomText::color_along),
      text_field("roughness_map",
                 "Of a hair mesh: image whose first channel, as it stands in the file, multiplies the material's "
                 "roughness over u and v",
                 &GroomText::roughness_map),
      text_field("roughness_along", "Of a hair mesh: the same from root to tip, in its first row", &GroomText::roughness_along),
      text_field("tilt_map", "Of a hair mesh: image whose first channel multiplies the cuticle tilt over u and v",
                 &GroomText::tilt_map),
      text_field("tilt_along", "Of a hair mesh: the same from root to tip, in its first row", &GroomText::tilt_along),
  };
  return table;
}

const Fields<SwrSettings>& swr_fields() {
  using S = SwrSettings;
  static const Names<SwrAlpha> alphas{
      {"kernel", SwrAlpha::kKernel}, {"ratio", SwrAlpha::kRatio}, {"coverage", SwrAlpha::kCoverage}};
  static const Fields<S> table{
      boolean_field("lod", "Whether bundles that are small on the screen have fewer strands and points", &S::lod),
      integer_field("points", "Control points of a strand at full detail", &S::points, 3, 127),
      boolean_field("thicken", "Whether strands take over the width of those that are left out", &S::thicken),
      boolean_field("depth_correction", "Whether light comes through strands that are left out", &S::depth_correction),
      boolean_field("filter", "Whether pictures of one sample are reconnected and smoothed along strands", &S::filter),
      integer_field("radius", "Pixels from the middle to the side of the filter's window", &S::radius, 1, 15),
      number_field("s_parallel", "Standard deviation along the strand, over the radius", &S::s_parallel, 0.01, 100),
      number_field("s_perpendicular", "Standard deviation across it, over the radius", &S::s_perpendicular, 0.01, 100),
      number_field("sigma_color", "Linear radiance", &S::sigma_color, 1e-6, 1e6),
      number_field("depth_tolerance", "Share of the hair's depth within which neighbors count", &S::depth_tolerance, 0, 1),
      number_field("connect_depth", "Share of the hair's depth from which a strand is another one", &S::connect_depth, 0, 1),
      number_field("strip", "Pixels, half the width of the strip in which hits are counted", &S::strip, 0, 15),
      choice_field("alpha", "Opacity: share of center hits along the strand, or exact area", &S::alpha, alphas),
      boolean_field("occlusion", "Whether baked occlusion dims the light of the probe", &S::occlusion),
  };
  return table;
}

const Fields<ThickHairSettings>& thick_hair_fields() {
  using T = ThickHairSettings;
  static const Names<ThickScattering> scattering{{"aggregate", ThickScattering::kAggregate},
                                                 {"fiber", ThickScattering::kFiber}};
  static const Names<LodShape> shapes{
      {"thick", LodShape::kThickHairs}, {"strands", LodShape::kStrands}, {"cards", LodShape::kCards}};
  static const Fields<T> table{
      boolean_field("on", "Whether clusters that are small on the screen are drawn as thick hairs", &T::on),
      number_field("pixels", "Widest thick hairs on the screen", &T::pixels, 0.1, 64),
      number_field("error", "FLIP that may be predicted of them instead; 0: by `pixels`, as cards always are", &T::error, 0,
                   0.2),
      number_field(
          "blend",
          "Hairs wider than 1 − blend of that fade out while their children fade in; 0: at once. Not with `level`, and of "
          "thick hairs alone",
          &T::blend, 0, 0.9),
      integer_field("level", "The one level that is drawn, 0 the coarsest; -1: by `pixels` or `error`", &T::level, -1, 15),
      choice_field("shape", "What stands for clusters: thick hairs, as many of their strands, or cards", &T::shape, shapes),
      choice_field("scattering", "What thick hairs scatter: as the bundle they stand for, or as one fiber", &T::scattering,
                   scattering),
  };
  return table;
}

const Fields<LinkSettings>& link_fields() {
  using L = LinkSettings;
  static const Names<LinkAlpha> alphas{
      {"count", LinkAlpha::kCount}, {"coverage", LinkAlpha::kCoverage}, {"none", LinkAlpha::kNone}};
  static const Fields<L> table{
      boolean_field("link", "Whether missed pixels of strands are filled", &L::link),
      number_field("alignment", "How well a strand has to fit an empty pixel", &L::alignment, 0, 1),
      number_field("sigma", "Pixels within which strands are looked for", &L::sigma, 0.1, 10),
      number_field("depth_sigma", "Share of the distance by which strands behind count less; 0: not at all", &L::depth_sigma, 0,
                   1e6),
      choice_field("alpha", "Opacity of linked strands: hit over all pixels, exact area, or none", &L::alpha, alphas),
      boolean_field("filter", "Whether hair is smoothed along its strands", &L::filter),
      number_field("kernel_size", "Half of the kernel's major axis, over the size of the hair; 0: kernel_radius",
                   &L::kernel_size, 0, 1),
      number_field("kernel_radius", "Pixels, half of the kernel's major axis for thin hair; it adapts to other hair",
                   &L::kernel_radius, 0, 64),
      number_field("aspect", "Minor over major axis of the kernel", &L::aspect, 0, 1),
      number_field("falloff", "Standard deviations of the kernel, over half of its axes", &L::falloff, 1e-3, 1e6),
      number_field("sigma_distance", "In units of half the major axis; endless without it", &L::sigma_distance, 1e-3, 1e6),
      number_field("sigma_angle", "Radians; endless without it", &L::sigma_angle, 1e-3, 1e6),
      number_field("sigma_color", "Linear radiance; endless without it", &L::sigma_color, 1e-6, 1e6),
  };
  return table;
}

/// The choice of a method: linking takes one sample a pixel where nothing else is said.
Field<RenderSettings> method_field() {
  static const Names<Method> methods{{"msaa", Method::kMsaa},        {"ssaa", Method::kSsaa}, {"taa", Method::kTaa},
                                     {"fxaa", Method::kFxaa},        {"smaa", Method::kSmaa}, {"link", Method::kLink},
                                     {"link-taa", Method::kLinkTaa}, {"oidn", Method::kOidn}, {"swr", Method::kSwr}};
  Field<RenderSettings> field = choice_field("method", "How the picture is anti-aliased", &RenderSettings::method, methods);
  field.read = [read = field.read](const JsonValue& v, RenderSettings& out) {
    read(v, out);
    if (is_linking(out.method) || out.method == Method::kSwr) out.samples = 1;
  };
  return field;
}

const Fields<RenderSettings>& settings_fields() {
  using S = RenderSettings;
  static const Names<AlphaSource> alphas{{"samples", AlphaSource::kSamples}, {"analytic", AlphaSource::kAnalytic}};
  static const Names<View> views{{"beauty", View::kBeauty},     {"strand-id", View::kStrandId}, {"u", View::kU},
                                 {"tangent", View::kTangent},   {"depth", View::kDepth},        {"coverage", View::kCoverage},
                                 {"overdraw", View::kOverdraw}, {"albedo", View::kAlbedo},      {"motion", View::kMotion},
                                 {"linked", View::kLinked},     {"alpha", View::kLinkAlpha},    {"lod", View::kLod}};
  static const Names<EnvironmentLighting> environments{{"pieces", EnvironmentLighting::kPieces},
                                                       {"probe", EnvironmentLighting::kProbe}};
  static const Names<ToneMap> tone_maps{{"aces", ToneMap::kAces}, {"none", ToneMap::kNone}};
  static const Fields<S> table{
      integer_field("width", "Pixels", &S::width, 1, 16384),
      integer_field("height", "Pixels", &S::height, 1, 16384),
      // Before the samples, whose range it decides.
      method_field(),
      {"samples",
       {{"description",
         "Per pixel: 1, 2, 4, 8 or 16 for msaa, 1, 4, 9 or 16 for link, 1, 2, 4 or 8 for swr, any number for ssaa"},
        {"type", "integer"},
        {"minimum", 1},
        {"maximum", 4096}},
       [](const JsonValue& v, S& out) {
         const long long n = v.integer(1, 4096);
         if (out.method == Method::kMsaa && !is_sample_count(static_cast<int>(n)))
           v.fail(std::to_string(n) + " samples per pixel", "1, 2, 4, 8 or 16; others with method ssaa");
         if (is_linking(out.method) && !is_link_sample_count(static_cast<int>(n)))
           v.fail(std::to_string(n) + " samples per pixel", "1, 4, 9 or 16 with method link");
         if (out.method == Method::kSwr && !is_deferred_sample_count(static_cast<int>(n)))
           v.fail(std::to_string(n) + " samples per pixel", "1, 2, 4 or 8 with method swr");
         out.samples = static_cast<int>(n);
       }},
      integer_field("frames", "Frames that taa takes of a still camera for one picture", &S::frames, 1, 4096),
      choice_field("alpha", "Opacity: share of covered samples, or exact area", &S::alpha, alphas),
      object_field("link", "Strand linking, of the methods link and link-taa", &S::link, link_fields()),
      object_field("swr", "Deferred software rasterization of hair meshes, of the method swr", &S::swr, swr_fields()),
      object_field("thick_hairs", "Level of detail of grooms with thick hairs (pelage lod build)", &S::thick_hairs,
                   thick_hair_fields()),
      choice_field("view", "What the picture shows", &S::view, views),
      number_field("exposure", "Stops", &S::exposure, -100, 100),
      choice_field("tone_map", "Curve of the display picture", &S::tone_map, tone_maps),
      vector_field("background", "Linear color where nothing is hit", &S::background, 0, kBright),
      boolean_field("transparent_background", "Keep alpha instead of the background", &S::transparent_background),
      integer_field("subdivisions", "Segments per span; 0 chooses from the projected curvature", &S::subdivisions, 0, 64),
      boolean_field("shadows", "Whether hair and meshes shade", &S::shadows),
      choice_field("environment_lighting", "Environment on strands: pieces with opacity maps, or a prefiltered probe",
                   &S::environment_lighting, environments),
      boolean_field("dual_scattering", "Multiple scattering between strands", &S::dual_scattering),
      integer_field("opacity_map_size", "Texels a side", &S::opacity_map_size, 64, 4096),
  };
  return table;
}

}  // namespace

const Fields<SceneText>& scene_fields() {
  static const Fields<SceneText> table{
      text_field("$schema", "For editors", &SceneText::schema),
      optional_object_field("camera", "Frames the grooms when absent", &SceneText::camera, camera_fields()),
      {"lights",
       {{"description", "A three-point light when neither lights nor environment are given"},
        {"type", "array"},
        {"items", object_schema(light_fields())}},
       [](const JsonValue& v, SceneText& out) {
         out.lights.emplace();
         for (const JsonValue& light : v.elements()) read_object(light, light_fields(), out.lights->emplace_back());
       }},
      optional_object_field("environment", "Light from far away", &SceneText::environment, environment_fields()),
      list_field("meshes", "Opaque geometry", &SceneText::meshes, mesh_fields()),
      list_field("grooms", "Hair and fur", &SceneText::grooms, groom_fields()),
      object_field("settings", "How the picture is made", &SceneText::settings, settings_fields()),
  };
  return table;
}

SceneText read_scene_text(const std::string& name, std::vector<char> json) {
  const JsonDocument document(name, std::move(json), "a scene file is JSON; see docs/scene.schema.json");
  SceneText text;
  read_object(JsonValue(document), scene_fields(), text);
  return text;
}

std::string scene_schema() {
  Schema schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                {"title", "Pelage scene"},
                {"description", "Lengths in meters, angles in degrees, Y up, right-handed. Made by `pelage render --schema`."}};
  schema.update(object_schema(scene_fields()));
  return schema.dump(2) + "\n";
}

Affine to_affine(const TransformText& t) {
  const auto angle = [](float degrees) { return static_cast<double>(degrees) * kDegree; };
  const double cx = std::cos(angle(t.rotate.x)), sx = std::sin(angle(t.rotate.x));
  const double cy = std::cos(angle(t.rotate.y)), sy = std::sin(angle(t.rotate.y));
  const double cz = std::cos(angle(t.rotate.z)), sz = std::sin(angle(t.rotate.z));
  const double r[3][3] = {{cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx},
                          {sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx},
                          {-sy, cy * sx, cy * cx}};
  const float move[3] = {t.translate.x, t.translate.y, t.translate.z};
  Affine a;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) a.m[i][j] = static_cast<float>(r[i][j] * t.scale);
    a.m[i][3] = move[i];
  }
  return a;
}

}  // namespace pelage::io
