#include "groom/hairmesh/fit_report.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kStep = 8;  // of the points of a strand every eighth is measured

/// Distances of strands to their base, strand after strand.
std::vector<float> base_distances(const FitStrands& f, const std::vector<FitBundle>& bundles) {
  std::vector<std::vector<float>> of(bundles.size());
  parallel_for(bundles.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> base;
    for (std::size_t b = begin; b < end; ++b) {
      const FitBundle& bundle = bundles[b];
      const LayerSpline spline(static_cast<std::uint32_t>(bundle.columns[0].size()), FitStrands::kPoints);
      for (std::size_t i = 0; i < bundle.strands.size(); ++i) {
        base_vertices(bundle, bundle.uv[i], base);
        for (std::size_t k = 0; k < FitStrands::kPoints; k += kStep) {
          const float t = static_cast<float>(k) / static_cast<float>(FitStrands::kPoints - 1);
          of[b].push_back(length(f.strand(bundle.strands[i])[k] - spline.at(base.data(), t * bundle.tip[i])));
        }
      }
    }
  });
  std::vector<float> all;
  for (const auto& some : of) all.insert(all.end(), some.begin(), some.end());
  return all;
}

ExpandSettings as_many(const HairMesh& mesh, std::size_t strands) {
  ExpandSettings e;
  e.share = static_cast<float>(std::min(1., static_cast<double>(strands) / static_cast<double>(strand_count(mesh))));
  return e;
}

/// Root mean square of the way between the same points of the mesh's strands with and without what shifts them.
double operator_rms(const HairMesh& mesh, const ExpandSettings& settings, const StrandSet& styled) {
  HairMesh plain = mesh;
  for (std::vector<StyleOperator>& style : plain.styles)
    std::erase_if(style, [](const StyleOperator& o) { return o.kind != StyleOperator::Kind::kLength; });
  const StrandSet base = expand(plain, settings);
  double sum = 0;
  for (std::size_t i = 0; i < base.point_count(); ++i) {
    const Vec3 d = styled.points[i] - base.points[i];
    sum += static_cast<double>(dot(d, d));
  }
  return std::sqrt(sum / static_cast<double>(base.point_count()));
}

/// Cells of the plane across `axis` that hair passes through.
class Silhouette {
 public:
  Silhouette(const Bounds& box, int axis) : box_(box), axis_(axis), size_(longest(box) / kCells), seen_(kSide * kSide) {}

  void add(Vec3 a, Vec3 b) {
    const int pieces = 1 + static_cast<int>(2 * length(b - a) / size_);
    for (int i = 0; i < pieces; ++i) add(lerp(a, b, static_cast<float>(i) / static_cast<float>(pieces)));
  }
  /// Cells of both over cells of either.
  static double overlap(const Silhouette& a, const Silhouette& b) {
    std::size_t both = 0, either = 0;
    for (std::size_t i = 0; i < a.seen_.size(); ++i) both += a.seen_[i] && b.seen_[i], either += a.seen_[i] || b.seen_[i];
    return either == 0 ? 1 : static_cast<double>(both) / static_cast<double>(either);
  }

 private:
  static constexpr int kCells = 128, kSide = kCells + 1;
  static float longest(const Bounds& box) {
    const Vec3 e = box.extent();
    return std::max({e.x, e.y, e.z, 1e-9f});
  }
  void add(Vec3 p) {
    const Vec3 d = (p - box_.lower) / size_;
    const float x = axis_ == 0 ? d.y : d.x, y = axis_ == 2 ? d.y : d.z;
    const auto cell = [](float v) { return static_cast<std::size_t>(std::clamp(v, 0.f, static_cast<float>(kCells))); };
    seen_[cell(y) * kSide + cell(x)] = true;
  }
  Bounds box_;
  int axis_;
  float size_;
  std::vector<bool> seen_;
};

double silhouette_overlap(const FitStrands& f, const StrandSet& styled) {
  Bounds box = bounds(styled);
  for (const Vec3 p : f.points) box.extend(p);
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Silhouette truth(box, axis), fit(box, axis);
    for (std::size_t s = 0; s < f.count(); ++s)
      for (std::size_t k = 1; k < FitStrands::kPoints; ++k) truth.add(f.strand(s)[k - 1], f.strand(s)[k]);
    for (std::size_t s = 0; s < styled.strand_count(); ++s)
      for (std::size_t k = styled.offsets[s] + 1; k < styled.offsets[s + 1]; ++k)
        fit.add(styled.points[k - 1], styled.points[k]);
    sum += Silhouette::overlap(truth, fit) / 3;
  }
  return sum;
}

}  // namespace

void measure_fit(const FitStrands& f, const std::vector<FitBundle>& bundles, const HairMesh& mesh, HairMeshFitReport& r) {
  r.strands = strand_count(mesh), r.sampled = static_cast<std::uint32_t>(f.count());
  r.bundles = static_cast<std::uint32_t>(mesh.bundles.size()), r.vertices = static_cast<std::uint32_t>(mesh.vertex_count());
  r.layers = mesh.layers(mesh.bundles.front()), r.styles = static_cast<std::uint32_t>(mesh.styles.size());
  r.size = f.size;
  std::vector<float> distance = base_distances(f, bundles);
  double sum = 0;
  for (const float d : distance) sum += static_cast<double>(d) * static_cast<double>(d);
  r.base_rms = std::sqrt(sum / static_cast<double>(distance.size()));
  const auto p95 = distance.begin() + static_cast<std::ptrdiff_t>(distance.size() * 95 / 100);
  std::nth_element(distance.begin(), p95, distance.end());
  r.base_p95 = static_cast<double>(*p95);
  const ExpandSettings settings = as_many(mesh, f.count());
  const StrandSet styled = expand(mesh, settings);
  r.operator_rms = operator_rms(mesh, settings, styled);
  r.silhouette_overlap = silhouette_overlap(f, styled);
}

}  // namespace pelage
