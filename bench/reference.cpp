// reference: rays per second of the path tracer's scene against bare Embree on the very same rays, paths per second, and
// the radiance of a white furnace.
#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <pelage/grow.h>

#include <atomic>
#include <cmath>
#include <map>

#include "bench.h"
#include "core/parallel.h"
#include "core/rng.h"
#include "frame/camera_view.h"
#include "reference/path_tracer.h"
#include "reference/ray_scene.h"

namespace pelage::bench {
namespace {

constexpr int kSize = 384;               ///< pixels a side
constexpr double kMostDifferent = 1e-3;  ///< share of rays that robust and plain traversal may answer differently
constexpr double kFurnaceError = 0.005;

struct Groom {
  const char* name;
  HairStyle style;
  int strands, points;
};
constexpr Groom kGrooms[] = {{"straight10k", HairStyle::kStraight, 10000, 32},
                             {"curly10k", HairStyle::kCurly, 10000, 32},
                             {"straight50k", HairStyle::kStraight, 50000, 32},
                             {"curly50k", HairStyle::kCurly, 50000, 32}};

Scene scene_of(const Groom& groom) {
  GrowSettings settings = grow_defaults(groom.style);
  settings.strands = groom.strands, settings.points = groom.points;
  Scene scene;
  scene.grooms.emplace_back();
  scene.grooms[0].strands = std::make_shared<const StrandSet>(grow(settings, mannequin_head()));
  scene.settings.width = scene.settings.height = kSize;
  add_default_camera(scene);
  add_default_lights(scene);
  return scene;
}

/// The strands of a scene as Embree takes them, with no flag set and nothing around it.
class BareScene {
 public:
  explicit BareScene(const StrandSet& set) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    for (std::size_t s = 0; s < set.strand_count(); ++s) {
      const std::uint32_t begin = set.offsets[s], end = set.offsets[s + 1];
      const auto add = [&](Vec3 p, std::size_t i) { points_.emplace_back(p.x, p.y, p.z, 0.5f * set.width(i)); };
      for (std::uint32_t i = begin; i + 1 < end; ++i) first_.push_back(static_cast<std::uint32_t>(points_.size()) + i - begin);
      add(set.points[begin] * 2.f - set.points[begin + 1], begin);
      for (std::uint32_t i = begin; i < end; ++i) add(set.points[i], i);
      add(set.points[end - 1] * 2.f - set.points[end - 2], end - 1);
    }
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_FLAT_CATMULL_ROM_CURVE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, points_.data(), 0, sizeof(Vec4),
                               points_.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, first_.data(), 0, 4, first_.size());
    rtcSetGeometryTessellationRate(geometry, kCurveTessellation);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~BareScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  BareScene(const BareScene&) = delete;
  BareScene& operator=(const BareScene&) = delete;
  RTCScene scene() const { return scene_; }

 private:
  std::vector<Vec4> points_;
  std::vector<std::uint32_t> first_;
  RTCDevice device_;
  RTCScene scene_;
};

RTCRayHit embree_query(const Ray& ray) {
  RTCRayHit q{};
  q.ray.org_x = ray.origin.x, q.ray.org_y = ray.origin.y, q.ray.org_z = ray.origin.z, q.ray.tnear = ray.near;
  q.ray.dir_x = ray.direction.x, q.ray.dir_y = ray.direction.y, q.ray.dir_z = ray.direction.z, q.ray.tfar = ray.far;
  q.ray.mask = ~0u;
  q.hit.geomID = q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return q;
}

/// The camera's rays, and rays from what they meet to everywhere.
struct Rays {
  Scene scene;
  RayScene ours;
  BareScene bare;
  std::vector<Ray> primary, shadow;

  explicit Rays(const Groom& groom) : scene(scene_of(groom)), ours(scene, CurveShape::kFlat), bare(*scene.grooms[0].strands) {
    const CameraView view = make_camera_view(scene.camera, kSize, kSize);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const Ray ray = camera_ray(view, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        primary.push_back(ray);
        const SceneHit hit = ours.intersect(ray);
        if (hit.kind != SceneHit::Kind::kStrand) continue;
        const StrandPlace place = ours.strand_place(hit);
        Rng rng(1, static_cast<std::uint32_t>(shadow.size()));
        const Vec3 direction = normalize(Vec3(rng.normal(), rng.normal(), rng.normal()));
        shadow.push_back({place.axis, direction, 4 * place.radius});
      }
  }
};

/// Calls trace(ray) → whether it met something for all rays, on all threads; the number that did.
template <class Trace>
std::size_t count_hits(const std::vector<Ray>& rays, const Trace& trace) {
  std::atomic<std::size_t> hits{0};
  parallel_for(rays.size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::size_t found = 0;
    for (std::size_t i = begin; i < end; ++i) found += trace(rays[i]);
    hits += found;
  });
  return hits;
}

struct Tracer {
  const char* name;
  std::size_t (*run)(const Rays&);
};

std::size_t our_primary(const Rays& r) {
  return count_hits(r.primary, [&](const Ray& ray) {
    const SceneHit hit = r.ours.intersect(ray);
    return hit.kind == SceneHit::Kind::kStrand && r.ours.strand_place(hit).radius >= 0;
  });
}
std::size_t bare_primary(const Rays& r) {
  return count_hits(r.primary, [&](const Ray& ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query = embree_query(ray);
    rtcIntersect1(r.bare.scene(), &context, &query);
    return query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  });
}
std::size_t our_shadow(const Rays& r) {
  return count_hits(r.shadow, [&](const Ray& ray) { return r.ours.occluded(ray); });
}
std::size_t bare_shadow(const Rays& r) {
  return count_hits(r.shadow, [&](const Ray& ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query = embree_query(ray);
    rtcOccluded1(r.bare.scene(), &context, &query.ray);
    return query.ray.tfar < 0;
  });
}

std::shared_ptr<const Rays> rays_of(const Groom& groom) {
  static std::map<std::string, std::weak_ptr<const Rays>> made;
  std::shared_ptr<const Rays> rays = made[groom.name].lock();
  if (!rays) made[groom.name] = rays = std::make_shared<const Rays>(groom);
  return rays;
}

std::string same_hits(std::size_t ours, std::size_t bare, std::size_t rays) {
  const double difference = std::fabs(static_cast<double>(ours) - static_cast<double>(bare));
  return difference <= kMostDifferent * static_cast<double>(rays)
             ? ""
             : fmt::format("{} of {} rays hit, bare Embree {}", ours, rays, bare);
}

void add_ray_cases(Suite& suite, const Groom& groom) {
  struct Kind {
    const char* name;
    std::size_t (*ours)(const Rays&);
    std::size_t (*bare)(const Rays&);
    std::vector<Ray> Rays::*rays;
  };
  static constexpr Kind kKinds[] = {{"primary", our_primary, bare_primary, &Rays::primary},
                                    {"shadow", our_shadow, bare_shadow, &Rays::shadow}};
  for (const Kind& kind : kKinds) {
    const std::string ours = fmt::format("reference.{}.{}", kind.name, groom.name),
                      bare = fmt::format("reference.{}_bare.{}", kind.name, groom.name);
    const auto add = [&](const std::string& name, std::size_t (*run)(const Rays&)) {
      suite.cases.push_back(
          {name, "rays_per_second", "1/s", [&groom, &kind, run] {
             const auto in = rays_of(groom);
             return Workload{
                 .check = [in, &kind] { return same_hits(kind.ours(*in), kind.bare(*in), (*in.*kind.rays).size()); },
                 .run = [in, run] { run(*in); },
                 .items = static_cast<double>((*in.*kind.rays).size())};
           }});
    };
    add(ours, kind.ours), add(bare, kind.bare);
    suite.ratios.push_back({fmt::format("reference.{}_share.{}", kind.name, groom.name), {ours}, {bare}});
  }
}

/// Whole paths of 12 bounces at most under the default lights; a sample that is not finite fails.
void add_path_case(Suite& suite, const Groom& groom) {
  const std::string name = fmt::format("reference.path.{}", groom.name);
  suite.cases.push_back({name, "samples_per_second", "1/s", [&groom] {
                           PathSettings settings;
                           settings.max_bounces = 12;
                           const auto tracer = std::make_shared<const PathTracer>(scene_of(groom), settings);
                           const auto run = [tracer] {
                             std::atomic<bool> finite{true};
                             parallel_for(kSize, 4, [&](std::size_t begin, std::size_t end) {
                               for (std::size_t y = begin; y < end; ++y)
                                 for (int x = 0; x < kSize; ++x)
                                   if (!is_finite(tracer->sample(x, static_cast<int>(y), 0).radiance)) finite = false;
                             });
                             return finite.load();
                           };
                           return Workload{.check = [run] { return run() ? "" : "a sample is not finite"; },
                                           .run = [run] { run(); },
                                           .items = double{kSize} * kSize};
                         }});
  suite.ratios.push_back({fmt::format("reference.path_scaling.{}", groom.name), {name, 2}, {name, 1}});
}

/// Mean radiance of 10,000 white strands in a world of radiance 1.
double furnace_radiance(HairMaterial::Model model) {
  Scene scene = scene_of(kGrooms[1]);
  scene.lights.clear();
  scene.environment = {};
  scene.environment.radiance = {1, 1, 1};
  scene.settings.width = scene.settings.height = 128;
  scene.grooms[0].material.model = model;
  scene.grooms[0].material.eumelanin = scene.grooms[0].material.pheomelanin = 0;
  PathSettings settings;
  settings.max_bounces = 1000;
  const PathTracer tracer(scene, settings);
  constexpr std::size_t kRows = 128;
  std::vector<double> sum(kRows), count(kRows);
  parallel_for(kRows, 1, [&](std::size_t y, std::size_t) {
    for (int x = 0; x < 128; ++x)
      for (std::uint32_t i = 0; i < 64; ++i) {
        const PathSample s = tracer.sample(x, static_cast<int>(y), i);
        if (s.hair) sum[y] += static_cast<double>(s.radiance.x + s.radiance.y + s.radiance.z) / 3, ++count[y];
      }
  });
  double total = 0, n = 0;
  for (std::size_t y = 0; y < kRows; ++y) total += sum[y], n += count[y];
  return total / n;
}

void add_furnace_case(Suite& suite, const char* name, HairMaterial::Model model) {
  suite.cases.push_back({fmt::format("reference.furnace.{}", name), "radiance", "1", [model] {
                           const double radiance = furnace_radiance(model);
                           return Workload{.check =
                                               [radiance] {
                                                 return std::fabs(radiance - 1) <= kFurnaceError
                                                            ? ""
                                                            : fmt::format("the furnace is {} instead of 1", radiance);
                                               },
                                           .measure = [radiance] { return radiance; }};
                         }});
}

}  // namespace

void add_reference_cases(Suite& suite) {
  for (const Groom& groom : kGrooms) add_ray_cases(suite, groom);
  for (const Groom& groom : kGrooms) add_path_case(suite, groom);
  add_furnace_case(suite, "marschner", HairMaterial::Model::kMarschner);
  add_furnace_case(suite, "zhu", HairMaterial::Model::kZhu);
}

}  // namespace pelage::bench
