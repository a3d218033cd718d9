#include "reference/path_tracer.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "frame/camera_view.h"
#include "frame/section.h"
#include "frame/segment_lookup.h"
#include "kernel/scalar.h"
#include "reference/dual_light.h"
#include "reference/light_sampler.h"
#include "reference/ray_scene.h"
#include "reference/sequence.h"
#include "reference/silhouette.h"
#include "reference/vertex.h"

namespace pelage {
namespace {

float largest(Vec3 c) { return std::max({c.x, c.y, c.z}); }

/// Share of an estimate with density `p` where the other technique has `q`: Veach 1997, section 9.2.4
/// (references.bib: Veach1997Robust).
float power_heuristic(float p, float q) {
  const float r = q / p;
  return 1 / (1 + r * r);
}

using Shares = std::array<Vec3, PathSplit::kLobes>;

/// Share of each lobe in what `bsdf` scatters from `to_light`.
Shares lobe_shares(const Bsdf& bsdf, Vec3 to_light) {
  Shares shares;
  Vec3 sum;
  for (std::size_t k = 0; k < shares.size(); ++k) {
    shares[k] = evaluate_lobe(bsdf, to_light, static_cast<int>(k));
    sum += shares[k];
  }
  const Vec3 inverse(sum.x > 0 ? 1 / sum.x : 0, sum.y > 0 ? 1 / sum.y : 0, sum.z > 0 ? 1 / sum.z : 0);
  for (Vec3& s : shares) s = s * inverse;
  return shares;
}

/// Adds up what a path finds.
struct Tally {
  PathSample& result;
  Shares shares{};  ///< of the first hit's lobes in what comes along the path after it

  void add(Vec3 radiance, int scatterings) {
    result.radiance += radiance;
    if (!result.split) return;
    result.split->bounces[std::min(static_cast<std::size_t>(scatterings), PathSplit::kBounces - 1)] += radiance;
    for (std::size_t k = 0; k < shares.size(); ++k) result.split->lobes[k] += radiance * shares[k];
  }
};

/// The fibers of a thick hair beside the one that a ray from `to_eye` met.
kernel::ScatterBundle other_fibers(const ThickPlace& place, Vec3 to_eye) {
  constexpr float kLeast = 1e-7f;  // metres, of a bundle without width
  const float half_width = std::max(0.5f * section_extent(place.major, place.minor, place.tangent, to_eye).width, kLeast);
  const float area = std::fabs(dot(place.tangent, cross(place.major, place.minor)));  // over π
  return kernel::scatter_bundle_buffon(std::max(place.fibers - 1, 0.f), place.radius, half_width,
                                       std::max(area / half_width, kLeast));
}

struct MeshMaterial {
  float specular, roughness;
};

std::vector<FiberMaterial> fibers_of(const std::vector<GroomInstance>& grooms) {
  std::vector<FiberMaterial> all;
  for (const GroomInstance& g : grooms) all.emplace_back(g.material, FiberMaterial::Tables::kWherePossible);
  return all;
}

std::vector<MeshMaterial> materials(const std::vector<MeshInstance>& meshes) {
  std::vector<MeshMaterial> all;
  for (const MeshInstance& m : meshes) all.push_back({m.specular, m.roughness});
  return all;
}

}  // namespace

struct PathTracer::State {
  PathSettings settings;
  CameraView view, previous_view;
  std::vector<GroomInstance> grooms;
  std::vector<FiberMaterial> fibers;  ///< [grooms]
  std::vector<MeshMaterial> mesh_materials;
  bool aggregate;  ///< thick hairs scatter as the bundles that they stand for; false: as one fiber
  bool environment_visible;
  RayScene rays;
  Silhouette silhouette;
  LightSampler lights;
  bool seek_environment;  ///< by rays toward it
  std::optional<DualLight> dual;

  struct ScatteredRay {
    Vec3 direction;
    Vec3 weight;            ///< what throughput becomes; 0: the path ends
    float found_share = 0;  ///< of the environment's light that counts where the ray finds it
  };

  /// A path on its way from the eye.
  struct Walk {
    Sequence& random;
    Tally& tally;
    Vec3 throughput{1, 1, 1};
    Ray ray{};       ///< that left the last vertex
    SceneHit hit{};  ///< what it met
  };

  State(const Scene& scene, const PathSettings& s);

  Vertex vertex(const SceneHit& hit, const Ray& ray) const;
  Vertex first_vertex(const SceneHit& hit, const Ray& ray, Vec2 at, PathSample& result) const;
  Vertex thick_vertex(const SceneHit& hit, const Ray& ray) const;
  bool visible(const Vertex& vertex, const LightRay& light, RandomBits key) const;
  void gather(const Vertex& vertex, const LightRay& light, RandomBits key, Vec3 throughput, int depth, Tally& tally) const;
  void gather_lights(const Vertex& vertex, std::array<float, 4> u, int depth, Walk& walk) const;
  ScatteredRay scatter_ray(const Vertex& vertex, std::array<float, 4> u, int depth) const;
  bool scatter(const Vertex& vertex, int depth, int max_bounces, Walk& walk) const;
  void transport(const Vertex& first, int max_bounces, Sequence& random, Tally& tally) const;
  void gather_dual(const Vertex& vertex, const SceneHit& hit, const Ray& ray, Sequence& random, Tally& tally) const;
  Vec3 color_of(const SceneHit& hit) const;
  Finish finish_of(const SceneHit& hit) const;
  void see_environment(Vec3 direction, PathSample& result) const;
  PathSample sample(int x, int y, std::uint32_t index) const;
};

PathTracer::State::State(const Scene& scene, const PathSettings& s)
    : settings(s), view(make_camera_view(scene.camera, scene.settings.width, scene.settings.height)),
      previous_view(s.previous_camera ? make_camera_view(*s.previous_camera, scene.settings.width, scene.settings.height)
                                      : view),
      grooms(scene.grooms), fibers(fibers_of(grooms)), mesh_materials(materials(scene.meshes)),
      aggregate(scene.settings.thick_hairs.scattering == ThickScattering::kAggregate),
      environment_visible(scene.environment.visible),
      rays(scene, s.integrator == Integrator::kDual ? CurveShape::kFlat : s.curve_shape), silhouette(view), lights(scene) {
  PELAGE_CHECK(settings.max_bounces >= 1);
  rays.add_to(silhouette);
  if (settings.integrator == Integrator::kSingle) settings.max_bounces = 1;
  if (settings.integrator == Integrator::kDual) dual.emplace(grooms);
  // An environment that is the same everywhere is best found by the rays that scatter: their density is the integrand's.
  seek_environment = !lights.environment().black() && settings.technique != Technique::kBsdf &&
                     !(settings.technique == Technique::kMis && lights.environment().uniform());
}

/// Of a strand where it was met; its material looks at it only where colors are the strands' own.
Vec3 PathTracer::State::color_of(const SceneHit& hit) const {
  const GroomInstance& g = grooms[hit.object];
  if (g.material.color_source != HairMaterial::ColorSource::kStrand) return g.material.color;
  const StrandLabel label = rays.strand_label(hit);
  return strand_color(g, label.strand, label.span);
}

/// Of a strand where it was met, by the maps of its groom.
Finish PathTracer::State::finish_of(const SceneHit& hit) const {
  const GroomInstance& g = grooms[hit.object];
  if (!has_finish_maps(g)) return {};
  const StrandLabel label = rays.strand_label(hit);
  return strand_finish(g, label.strand, label.u);
}

/// A fiber of a thick hair where the ray met it, among the others.
Vertex PathTracer::State::thick_vertex(const SceneHit& hit, const Ray& ray) const {
  const ThickPlace place = rays.thick_place(hit);
  const Vec3 to_eye = normalize(-ray.direction);
  const Vec3 met = ray.origin + ray.direction * hit.distance;
  const GroomInstance& g = grooms[hit.object];
  const auto scattering = [&](const FiberMaterial& m) {
    return aggregate ? FiberBsdf(m, color_of(hit), place, to_eye, other_fibers(place, to_eye), met)
                     : FiberBsdf(m, color_of(hit), place.fiber_tangent(met), to_eye, 0);
  };
  return {met,
          place.fiber_tangent(met),
          {},
          0,
          has_finish_maps(g) ? scattering(FiberMaterial(finished(g.material, finish_of(hit)))) : scattering(fibers[hit.object]),
          hit};
}

/// What the ray met, ready to scatter toward the ray's origin.
Vertex PathTracer::State::vertex(const SceneHit& hit, const Ray& ray) const {
  if (hit.kind == SceneHit::Kind::kThickHair) return thick_vertex(hit, ray);
  const Vec3 to_eye = normalize(-ray.direction);
  if (hit.kind == SceneHit::Kind::kStrand) {
    const StrandPlace place = rays.strand_place(hit);
    const Vec3 off_axis = ray.origin + ray.direction * hit.distance - place.axis,
               side = normalize(cross(to_eye, place.tangent));
    const float h = place.radius > 0 ? std::clamp(dot(off_axis, side) / place.radius, -1.f, 1.f) : 0.f;
    const GroomInstance& g = grooms[hit.object];
    const auto scattering = [&](const FiberMaterial& m) { return FiberBsdf(m, color_of(hit), place.tangent, to_eye, h); };
    return {
        place.axis,
        place.tangent,
        {},
        place.radius,
        has_finish_maps(g) ? scattering(FiberMaterial(finished(g.material, finish_of(hit)))) : scattering(fibers[hit.object]),
        hit};
  }
  Surface s = rays.surface(hit);
  if (dot(s.geometric_normal, to_eye) < 0)
    s.normal = -s.normal, s.geometric_normal = -s.geometric_normal, s.lifted = s.position;
  const float scale = std::max({std::fabs(s.position.x), std::fabs(s.position.y), std::fabs(s.position.z), hit.distance});
  const MeshMaterial& m = mesh_materials[hit.object];
  return {s.lifted,
          {},
          s.geometric_normal,
          Vertex::kSurfaceOffset * scale,
          SurfaceBsdf(s.normal, to_eye, s.color, m.specular, m.roughness),
          hit};
}

/// The same for the camera's ray, which also tells what it met. `at`: place of the sample in the image, pixels.
Vertex PathTracer::State::first_vertex(const SceneHit& hit, const Ray& ray, Vec2 at, PathSample& result) const {
  Vertex v = vertex(hit, ray);
  const Vec3 to_eye = normalize(-ray.direction), met = ray.origin + ray.direction * hit.distance;
  result.alpha = 1;
  result.depth = hit.distance;
  result.position = v.hair() ? v.position : met;
  result.albedo = albedo(v.bsdf);
  result.normal = v.geometric_normal;
  if (v.hair()) {
    const StrandLabel label = rays.strand_label(hit);
    result.hair = true;
    result.tangent = v.tangent;
    result.normal = normalize(to_eye - v.tangent * dot(to_eye, v.tangent));
    result.groom = hit.object, result.strand = label.strand, result.u = label.u;
    result.width = 2 * (hit.kind == SceneHit::Kind::kThickHair ? rays.thick_place(hit).radius : v.radius);
  }
  const Vec3 before = transform_point(previous_view.world_to_camera, met);
  if (settings.previous_camera && before.z > 0) result.motion = project(previous_view, before) - at;
  return v;
}

bool PathTracer::State::visible(const Vertex& vertex, const LightRay& light, RandomBits key) const {
  if (!settings.shadows || !light.casts_shadow) return true;
  const Ray ray = vertex.ray(light.to_light, light.distance);
  return !(ray.near < ray.far) || !rays.occluded(ray, rays.passage_from(vertex.met, ray, key));
}

/// Light that comes straight from `light` and is scattered toward the eye.
void PathTracer::State::gather(const Vertex& vertex, const LightRay& light, RandomBits key, Vec3 throughput, int depth,
                               Tally& tally) const {
  if (!(largest(light.arriving) > 0)) return;
  Vec3 radiance = throughput * light.arriving * evaluate(vertex.bsdf, light.to_light);
  if (light.pdf > 0 && settings.technique == Technique::kMis)
    radiance *= power_heuristic(light.pdf, pdf(vertex.bsdf, light.to_light));
  if (!(largest(radiance) > 0) || !visible(vertex, light, key)) return;
  if (tally.result.split && depth == 0) tally.shares = lobe_shares(vertex.bsdf, light.to_light);
  tally.add(radiance, depth);
}

/// Where the eye's ray ends every light is looked for, later one of them.
void PathTracer::State::gather_lights(const Vertex& vertex, std::array<float, 4> u, int depth, Walk& walk) const {
  const Vec3 throughput = walk.throughput;
  const auto gather_one = [&](const LightRay& light, std::size_t number, Vec3 weight) {
    gather(vertex, light, walk.random.ray_key(1 + static_cast<std::uint32_t>(number)), weight, depth, walk.tally);
  };
  const std::size_t count = lights.lights().size();
  if (depth == 0) {
    for (std::size_t i = 0; i < count; ++i) gather_one(lights.toward(i, vertex.position), i, throughput);
    if (seek_environment) gather_one(lights.toward_environment({u[1], u[2]}, 1), count, throughput);
    return;
  }
  const LightSampler::Choice choice = lights.choose(u[0], seek_environment);
  if (!(choice.chance > 0)) return;
  if (choice.index == count) return gather_one(lights.toward_environment({u[1], u[2]}, choice.chance), count, throughput);
  gather_one(lights.toward(choice.index, vertex.position), choice.index, throughput / choice.chance);
}

/// Where rays toward it look for the environment too, one that scatters must tell how often it is drawn by any lobe.
PathTracer::State::ScatteredRay PathTracer::State::scatter_ray(const Vertex& vertex, std::array<float, 4> u, int depth) const {
  if (!seek_environment) {
    const ScatteredDirection s = pelage::scatter(vertex.bsdf, u);
    return {s.direction, s.weight, 1};
  }
  const FiberSample s = pelage::sample(vertex.bsdf, u);
  if (!(s.pdf > 0)) return {};
  if (settings.technique == Technique::kNee) return {s.direction, s.value / s.pdf, 0};
  const float chance = depth == 0 ? 1.f : lights.environment_chance();
  return {s.direction, s.value / s.pdf, power_heuristic(s.pdf, lights.environment().pdf(s.direction) * chance)};
}

/// One scattering event: adds what the lights send to it and what lies open beyond it. False where the path ends.
bool PathTracer::State::scatter(const Vertex& vertex, int depth, int max_bounces, Walk& walk) const {
  const EnvironmentSampler& environment = lights.environment();
  const bool lit = seek_environment || !lights.lights().empty();
  const bool roulette = depth >= settings.first_roulette;
  const std::array<float, 4> u = walk.random.next();
  std::array<float, 4> v{};
  if (lit || roulette) v = walk.random.next();
  else walk.random.skip();
  if (lit) gather_lights(vertex, v, depth, walk);
  const ScatteredRay scattered = scatter_ray(vertex, u, depth);
  walk.throughput = walk.throughput * scattered.weight;
  if (!(largest(walk.throughput) > 0)) return false;
  if (walk.tally.result.split && depth == 0) walk.tally.shares = lobe_shares(vertex.bsdf, scattered.direction);
  if (roulette) {
    const float survival = std::min(std::sqrt(largest(walk.throughput)), 1.f);
    if (!(v[3] < survival)) return false;
    walk.throughput = walk.throughput / survival;
  }
  const float share = environment.black() ? 0.f : scattered.found_share;
  const bool last = depth + 1 == max_bounces;
  if (last && !(share > 0)) return false;
  walk.ray = vertex.ray(scattered.direction);
  const Passage passage = rays.passage_from(vertex.met, walk.ray, walk.random.ray_key(0));
  bool open = false;
  if (!last) {
    walk.hit = rays.intersect(walk.ray, passage);
    open = walk.hit.kind == SceneHit::Kind::kNone;
  } else {
    open = !settings.shadows || !rays.occluded(walk.ray, passage);
  }
  if (share > 0 && (open || !settings.shadows))
    walk.tally.add(walk.throughput * environment.radiance(scattered.direction) * share, depth);
  return !open && !last;
}

/// All light that leaves the first vertex toward the eye.
void PathTracer::State::transport(const Vertex& first, int max_bounces, Sequence& random, Tally& tally) const {
  Walk walk{random, tally};
  if (!scatter(first, 0, max_bounces, walk)) return;
  for (int depth = 1; scatter(vertex(walk.hit, walk.ray), depth, max_bounces, walk);) ++depth;
}

/// Light that leaves a strand toward the eye by dual scattering: one ray to every light counts the strands on its way.
void PathTracer::State::gather_dual(const Vertex& vertex, const SceneHit& hit, const Ray& ray, Sequence& random,
                                    Tally& tally) const {
  const DualPlace place = dual->place(hit.object, color_of(hit), finish_of(hit), vertex.tangent, normalize(-ray.direction));
  const auto gather_one = [&](const LightRay& light) {
    if (!(largest(light.arriving) > 0)) return;
    CrossedStrands crossed;
    const Ray way = vertex.ray(light.to_light, light.distance);
    if (settings.shadows && light.casts_shadow && way.near < way.far) {
      const auto cross = [&](const SceneHit& on_way) {
        dual->cross(crossed, on_way.object, color_of(on_way), finish_of(on_way), rays.strand_place(on_way).tangent,
                    light.to_light);
      };
      if (!rays.cross_strands(way, cross)) return;
    }
    const Vec3 radiance = light.arriving * DualLight::evaluate(place, light.to_light, crossed);
    if (tally.result.split) tally.shares = lobe_shares(vertex.bsdf, light.to_light);
    tally.add(radiance, crossed.count);
  };
  for (std::size_t i = 0; i < lights.lights().size(); ++i) gather_one(lights.toward(i, vertex.position));
  if (lights.environment().black()) return;
  // The fiber itself is narrow, what comes through others is wide: directions are drawn for one or the other.
  const EnvironmentSampler& environment = lights.environment();
  const std::array<float, 4> u = random.next(), v = random.next();
  const Vec3 direction = v[0] < 0.5f ? pelage::sample(vertex.bsdf, u).direction : environment.sample({v[1], v[2]});
  const float density = 0.5f * (pdf(vertex.bsdf, direction) + environment.pdf(direction));
  gather_one({direction, INFINITY, environment.radiance(direction) / density, density, true});
}

/// What a ray that meets nothing brings back.
void PathTracer::State::see_environment(Vec3 direction, PathSample& result) const {
  if (!environment_visible) return;
  result.alpha = 1;
  result.radiance = lights.environment().radiance(direction);
}

PathSample PathTracer::State::sample(int x, int y, std::uint32_t index) const {
  PELAGE_CHECK(x >= 0 && x < view.width && y >= 0 && y < view.height);
  PathSample result;
  if (settings.split) result.split.emplace();
  const bool covered = silhouette.covers(x, y);
  if (!covered && (!environment_visible || lights.environment().uniform())) {
    see_environment({0, 0, 1}, result);
    return result;
  }
  Sequence random(settings.seed,
                  static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(view.width) + static_cast<std::uint32_t>(x),
                  index);
  const std::array<float, 4> u = random.next();
  const Vec2 in_pixel = settings.positions.empty() ? Vec2(u[0], u[1]) : settings.positions[index % settings.positions.size()];
  const Vec2 at = Vec2(static_cast<float>(x), static_cast<float>(y)) + in_pixel;
  const Ray ray = camera_ray(view, at.x, at.y);
  const SceneHit hit = covered ? rays.intersect(ray, {random.ray_key(0), {}, 0}) : SceneHit();
  if (hit.kind == SceneHit::Kind::kNone) {
    see_environment(normalize(ray.direction), result);
    return result;
  }
  Tally tally{result};
  const Vertex vertex = first_vertex(hit, ray, at, result);
  if (dual && vertex.hair()) gather_dual(vertex, hit, ray, random, tally);
  else transport(vertex, dual ? 1 : settings.max_bounces, random, tally);
  return result;
}

PathTracer::PathTracer(const Scene& scene, const PathSettings& settings) : state_(std::make_unique<State>(scene, settings)) {}
PathTracer::~PathTracer() = default;
PathTracer::PathTracer(PathTracer&&) noexcept = default;

PathSample PathTracer::sample(int x, int y, std::uint32_t index) const { return state_->sample(x, y, index); }
std::size_t PathTracer::curve_count() const { return state_->rays.span_total(); }
std::size_t PathTracer::bytes() const { return state_->rays.bytes() + state_->lights.environment().bytes(); }

}  // namespace pelage
