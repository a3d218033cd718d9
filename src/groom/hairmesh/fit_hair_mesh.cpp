// Strands → clusters → cages → styles → hair mesh, and how near it comes.
#include <pelage/error.h>
#include <pelage/hair_mesh_fit.h>
#include <pelage/hair_mesh_styles.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/k_means.h"
#include "core/parallel.h"
#include "core/rng.h"
#include "core/shared_progress.h"
#include "groom/hairmesh/fit_bundle.h"
#include "groom/hairmesh/fit_report.h"
#include "groom/hairmesh/fit_style.h"

namespace pelage {
namespace {

template <class T>
void check_range(const char* name, T value, T low, T high) {
  if (!(value >= low && value <= high))
    throw Error("hair mesh fit", name, fmt::format("{} is outside {} … {}", value, low, high), "choose a value in that range");
}

void check(const StrandSet& strands, const HairMeshFitSettings& s) {
  check_range("bundles", s.bundles, 0u, 65536u);
  check_range("layers", s.layers, 2u, HairMesh::kMaxLayers);
  check_range("bytes", s.bytes, 1000u, 100000000u);
  check_range("styles", s.styles, 1u, 64u);
  check_range("sample", s.sample, 1u, 1000000u);
  validate(strands, "hair mesh fit");
  if (strands.strand_count() == 0) throw Error("hair mesh fit", "", "the groom has no strands", "give one that has");
}

/// As many as the file holds (docs/formats.md): four columns of their own, 10 bytes a vertex, 20 for the bundle itself.
std::uint32_t bundle_count(const HairMeshFitSettings& s) {
  const std::uint32_t vertices = 4 * s.layers, most = static_cast<std::uint32_t>(HairMesh::kMaxVertices) / vertices;
  if (s.bundles > 0) {
    if (s.bundles > most)
      throw Error("hair mesh fit", "bundles", fmt::format("{} of {} layers", s.bundles, s.layers),
                  fmt::format("{} at most", most));
    return s.bundles;
  }
  const std::uint32_t head = 80 + s.styles * 120, a_bundle = 10 * vertices + 4 + 20;
  return std::clamp((s.bytes - std::min(s.bytes, head)) / a_bundle, 1u, std::min(most, 65536u));
}

class MeshFitter {
 public:
  MeshFitter(const StrandSet& set, const HairMeshFitSettings& settings, const Progress& progress)
      : s_(settings), progress_(progress), total_(set.strand_count()), wanted_(bundle_count(settings)),
        strands_(sample_strands(set, settings.sample, progress)), spline_(settings.layers, FitStrands::kPoints) {
    if (strands_.count() == 0) throw Error("hair mesh fit", "", "no strand has any length", "give a groom that has hair");
    describe_strands();
  }

  HairMesh fit() {
    cluster();
    split_worst();
    put_bundles();
    find_styles();
    return std::move(mesh_);
  }
  const FitStrands& strands() const { return strands_; }
  const std::vector<FitBundle>& bundles() const { return bundles_; }
  double slow2() const { return all_.slow2; }
  double fast2() const { return all_.fast2; }

 private:
  /// The root, and the middle of the strand around some places along it, so that curls do not count.
  void describe_strands() {
    constexpr std::size_t kPlaces = 4;
    constexpr float kRoot = 1.5f;  // how much more than another place the root counts
    features_.dimension = 3 * kPlaces;
    features_.values.resize(strands_.count() * features_.dimension);
    parallel_for(strands_.count(), 512, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s)
        for (std::size_t p = 0; p < kPlaces; ++p) {
          const std::size_t last = FitStrands::kPoints - 1, at = p * last / (kPlaces - 1), around = p == 0 ? 0 : last / 10;
          const std::size_t first = at - std::min(at, around), end_at = std::min(at + around, last);
          Vec3 sum;
          for (std::size_t i = first; i <= end_at; ++i) sum += strands_.strand(s)[i];
          sum = sum * ((p == 0 ? kRoot : 1.f) / static_cast<float>(end_at - first + 1));
          float* to = &features_.values[s * features_.dimension + 3 * p];
          to[0] = sum.x, to[1] = sum.y, to[2] = sum.z;
        }
    });
  }

  /// Three quarters of the bundles: strands near each other all along.
  void cluster() {
    const auto most = static_cast<std::uint32_t>(std::min<std::size_t>(wanted_, strands_.count()));
    const std::vector<std::uint32_t> label = k_means(features_, std::max(1u, most * 3 / 4), s_.seed);
    bundles_.resize(1 + *std::max_element(label.begin(), label.end()));
    for (std::size_t s = 0; s < label.size(); ++s) bundles_[label[s]].strands.push_back(static_cast<std::uint32_t>(s));
    SharedProgress shared(progress_, "fit bundles", bundles_.size());
    parallel_for(bundles_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) fit_bundle(strands_, spline_, bundles_[b]);
      shared.add(end - begin);
    });
  }

  /// The others come from halving those that strands keep to least.
  void split_worst() {
    SharedProgress shared(progress_, "split bundles",
                          std::max<std::size_t>(1, wanted_ - std::min<std::size_t>(wanted_, bundles_.size())));
    while (bundles_.size() < wanted_) {
      const auto worst = std::max_element(bundles_.begin(), bundles_.end(),
                                          [](const FitBundle& a, const FitBundle& b) { return a.error < b.error; });
      if (!(worst->error > 0) || worst->strands.size() < 2) break;
      Features own;
      own.dimension = features_.dimension;
      for (const std::uint32_t s : worst->strands)
        own.values.insert(own.values.end(), features_.item(s), features_.item(s) + own.dimension);
      const std::vector<std::uint32_t> label = k_means(own, 2, s_.seed + 1);
      std::array<FitBundle, 2> half;
      for (std::size_t i = 0; i < label.size(); ++i) half[label[i]].strands.push_back(worst->strands[i]);
      if (half[1].strands.empty()) break;
      parallel_for(2, 1, [&](std::size_t b, std::size_t) { fit_bundle(strands_, spline_, half[b]); });
      *worst = std::move(half[0]);
      bundles_.push_back(std::move(half[1]));
      shared.add(1);
    }
  }

  void put_bundles() {
    mesh_.column_offsets = {0};
    mesh_.comment = fmt::format("fitted to {} strands", total_);
    std::uint64_t so_far = 0, given = 0;
    double width = 0;
    for (std::size_t s = 0; s < strands_.count(); ++s)
      width += static_cast<double>(strands_.widths[s * FitStrands::kWidths]) / static_cast<double>(strands_.count());
    mesh_.width = std::clamp(static_cast<float>(width), 0.f, 0.1f);
    const std::uint64_t spare = total_ - bundles_.size();  // one strand each, and the others by the sample's
    for (std::size_t b = 0; b < bundles_.size(); ++b) {
      const FitBundle& bundle = bundles_[b];
      so_far += bundle.strands.size();
      const std::uint64_t due = b + 1 + (spare * so_far + strands_.count() / 2) / strands_.count();
      if (due - given > HairMesh::kMaxStrands)
        throw Error("hair mesh fit", fmt::format("bundle {}", b), fmt::format("{} strands", due - given),
                    fmt::format("more bundles, of {} strands at most", HairMesh::kMaxStrands));
      const auto first = static_cast<std::uint32_t>(mesh_.column_count());
      const RandomBits bits = pcg4d(s_.seed, static_cast<std::uint32_t>(b), 0, 0x66697400u);
      mesh_.bundles.push_back({{first, first + 1, first + 2, first + 3}, static_cast<std::uint32_t>(due - given), 0, bits.x});
      given = due;
      for (std::size_t c = 0; c < 4; ++c) put_column(bundle, c);
    }
  }

  void put_column(const FitBundle& bundle, std::size_t c) {
    for (std::size_t k = 0; k < s_.layers; ++k) {
      mesh_.positions.push_back(bundle.columns[c][k]);
      mesh_.uvw.push_back(
          {bundle.groom_uv[c].x, bundle.groom_uv[c].y, static_cast<float>(k) / static_cast<float>(s_.layers - 1)});
    }
    mesh_.column_offsets.push_back(static_cast<std::uint32_t>(mesh_.positions.size()));
  }

  /// Bundles of like habits share a style, that of their mean.
  void find_styles() {
    std::vector<StrandHabits> habits(bundles_.size());
    SharedProgress shared(progress_, "fit styles", bundles_.size());
    parallel_for(bundles_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) habits[b] = measure_habits(strands_, bundles_[b]);
      shared.add(end - begin);
    });
    all_ = mean_habits(habits);
    Features f;
    f.dimension = 7;
    const auto level = [](double meters) { return static_cast<float>(std::log(meters + 1e-4)); };
    for (const StrandHabits& h : habits) {
      const std::array<float, 7> row{level(h.curl),
                                     h.curl > 0 ? static_cast<float>(std::log(h.frequency)) : 0.f,
                                     level(h.frizz),
                                     level(h.drift),
                                     static_cast<float>(2 * h.clump),
                                     static_cast<float>(0.5 * std::log(h.clumps)),
                                     static_cast<float>(h.length_variation)};
      f.values.insert(f.values.end(), row.begin(), row.end());
    }
    const std::vector<std::uint32_t> label = k_means(f, s_.styles, s_.seed);
    std::vector<std::vector<StrandHabits>> alike(1 + *std::max_element(label.begin(), label.end()));
    for (std::size_t b = 0; b < label.size(); ++b) alike[label[b]].push_back(habits[b]), mesh_.bundles[b].style = label[b];
    for (const auto& some : alike)
      mesh_.styles.push_back(s_.operators ? operators_of(mean_habits(some), mesh_.width) : std::vector<StyleOperator>());
  }

  const HairMeshFitSettings& s_;
  const Progress& progress_;
  std::uint64_t total_;
  std::uint32_t wanted_;
  FitStrands strands_;
  LayerSpline spline_;
  Features features_;
  std::vector<FitBundle> bundles_;
  StrandHabits all_;
  HairMesh mesh_;
};

}  // namespace

HairMesh fit_hair_mesh(const StrandSet& strands, const HairMeshFitSettings& settings, HairMeshFitReport* report,
                       const Progress& progress) {
  check(strands, settings);
  MeshFitter fitter(strands, settings, progress);
  HairMesh mesh = fitter.fit();
  validate(mesh, "fitted hair mesh");
  if (report) {
    *report = {};
    report->slow_rms = std::sqrt(fitter.slow2()), report->fast_rms = std::sqrt(fitter.fast2());
    measure_fit(fitter.strands(), fitter.bundles(), mesh, *report);
  }
  if (settings.occlusion) bake_occlusion(mesh, progress);
  return mesh;
}

}  // namespace pelage
