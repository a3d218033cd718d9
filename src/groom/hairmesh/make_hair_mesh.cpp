// The authored hair meshes: for each style how its columns run and which operators make hair of them.
#include <pelage/error.h>
#include <pelage/hair_mesh_styles.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "core/rng.h"
#include "groom/hairmesh/column_paths.h"
#include "groom/hairmesh/scalp_grid.h"
#include "groom/head_shape.h"
#include "groom/sdf.h"

namespace pelage {
namespace {

using namespace groom;
using Kind = StyleOperator::Kind;
using Operators = std::vector<StyleOperator>;

/// What makes a style. Columns of a style either fall, stand out as a ball, or are tied.
struct Recipe {
  ScalpGridSettings grid;
  int layers = 10;
  float denser_at_root = 0.35f;
  Fall fall;
  float ball_radius = 0;  ///< metres; 0: no ball
  Tie tie;
  int layers_to_tie = 0;    ///< 0: not tied
  bool whole_tail = false;  ///< every bundle fills the tail, as a braid wants it
  float strays = 0.012f;    ///< share of strands that keep to no lock: bundles of their own, in the second style
  Operators hair, stray;
};

Recipe bob() {
  Recipe r;
  r.grid = {.rows = 10, .across = 5, .parted = true};
  r.layers = 11;
  r.fall = {.lift = 0.26f,
            .bend_length = 0.040f,
            .volume = 0.013f,
            .length = 0.36f,
            .cut_front = -0.115f,
            .cut_back = -0.092f,
            .tuck = 0.7f};
  r.hair = {{Kind::kLength, 1.01f, 0, 0, 0.05f},
            {Kind::kClump, 0.30f, 4, 0.15f, 0.9f},
            {Kind::kNoise, 0.003f, 2.5f, 0.05f, 0.04f},
            {Kind::kFrizz, 0.0012f, 2.5f, 0.1f, 1},
            {Kind::kTaper, 0.55f, 0, 0.5f, 0.4f}};
  r.stray = {{Kind::kLength, 1.0f, 0, 0, 0.5f},
             {Kind::kNoise, 0.004f, 5, 0.05f, 0.5f},
             {Kind::kFrizz, 0.006f, 2, 0.05f, 0.8f},
             {Kind::kTaper, 0.3f, 0, 0.3f, 0.4f}};
  return r;
}

Recipe long_wavy() {
  Recipe r;
  r.grid = {.rows = 10, .across = 4, .parted = true, .divided = true};
  r.layers = 14;
  r.denser_at_root = 0.25f;
  r.fall = {.lift = 0.28f,
            .bend_length = 0.045f,
            .volume = 0.017f,
            .length = 0.47f,
            .cut_front = -0.235f,
            .cut_back = -0.265f,
            .ragged = 0.02f,
            .spread = 0.1f};
  r.hair = {{Kind::kLength, 1.02f, 0, 0, 0.14f},     {Kind::kClump, 0.66f, 3, 0.08f, 0.6f},
            {Kind::kWave, 0.0095f, 4, 0.16f, 0.10f}, {Kind::kNoise, 0.006f, 3, 0.05f, 0.04f},
            {Kind::kFrizz, 0.0016f, 4, 0.1f, 1},     {Kind::kTaper, 0.45f, 0, 0.5f, 0.4f}};
  r.stray = {{Kind::kLength, 1.0f, 0, 0, 0.6f},
             {Kind::kWave, 0.007f, 4, 0.1f, 1},
             {Kind::kNoise, 0.007f, 6, 0.05f, 0.5f},
             {Kind::kFrizz, 0.007f, 3, 0.05f, 0.8f},
             {Kind::kTaper, 0.3f, 0, 0.3f, 0.4f}};
  return r;
}

Recipe curls() {
  Recipe r;
  r.grid = {.rows = 10, .across = 5, .parted = true};
  r.layers = 10;
  r.fall = {.lift = 0.38f,
            .bend_length = 0.06f,
            .volume = 0.030f,
            .length = 0.34f,
            .cut_front = -0.120f,
            .cut_back = -0.150f,
            .cling = 0.10f,
            .ragged = 0.035f,
            .tuck = 0.35f,
            .spread = 0.28f};
  r.hair = {{Kind::kLength, 1.06f, 0, 0, 0.16f},        {Kind::kClump, 0.90f, 2, 0, 0.2f},
            {Kind::kCurl, 0.0085f, 6.5f, 0.05f, 0.05f}, {Kind::kNoise, 0.010f, 4, 0.05f, 0.03f},
            {Kind::kFrizz, 0.0016f, 6, 0.08f, 1},       {Kind::kTaper, 0.5f, 0, 0.5f, 0.4f}};
  r.strays = 0.03f;
  r.stray = {{Kind::kLength, 1.05f, 0, 0, 0.5f},
             {Kind::kCurl, 0.008f, 6, 0.05f, 1},
             {Kind::kNoise, 0.01f, 6, 0.05f, 0.5f},
             {Kind::kFrizz, 0.006f, 5, 0.05f, 0.8f},
             {Kind::kTaper, 0.3f, 0, 0.3f, 0.4f}};
  return r;
}

Recipe afro() {
  Recipe r;
  r.grid = {.rows = 12, .across = 6};
  r.layers = 5;
  r.denser_at_root = 0;
  r.ball_radius = 0.168f;
  r.hair = {{Kind::kLength, 1.04f, 0, 0, 0.3f},      {Kind::kClump, 0.55f, 5, 0.1f, 0.7f},
            {Kind::kCurl, 0.0045f, 8, 0.03f, 0.6f},  {Kind::kNoise, 0.009f, 16, 0.15f, 0.1f},
            {Kind::kFrizz, 0.0035f, 7, 0.05f, 0.7f}, {Kind::kTaper, 0.7f, 0, 0.5f, 0.3f}};
  r.strays = 0.02f;
  r.stray = {{Kind::kLength, 1.14f, 0, 0, 0.3f},
             {Kind::kCurl, 0.005f, 7, 0.03f, 1},
             {Kind::kFrizz, 0.007f, 6, 0.05f, 0.7f},
             {Kind::kTaper, 0.5f, 0, 0.3f, 0.4f}};
  return r;
}

Recipe ponytail() {
  Recipe r;
  r.grid = {.rows = 9, .across = 5};
  r.layers = 13;
  r.layers_to_tie = 6;
  r.tie = {.lift = 0.006f, .length = 0.30f, .radius = 0.030f, .tip = 0.4f};
  r.hair = {{Kind::kLength, 1.0f, 0, 0, 0.2f},       {Kind::kClump, 0.30f, 2, 0.45f, 0.9f},
            {Kind::kWave, 0.008f, 2.5f, 0.5f, 0.3f}, {Kind::kNoise, 0.003f, 4, 0.45f, 0.1f},
            {Kind::kFrizz, 0.0016f, 4, 0.3f, 1},     {Kind::kTaper, 0.5f, 0, 0.6f, 0.4f}};
  r.strays = 0.008f;
  r.stray = {{Kind::kLength, 0.9f, 0, 0, 0.9f},
             {Kind::kNoise, 0.003f, 6, 0.05f, 0.5f},
             {Kind::kFrizz, 0.006f, 3, 0.02f, 0.8f},
             {Kind::kTaper, 0.3f, 0, 0.3f, 0.4f}};
  return r;
}

Recipe braid() {
  Recipe r = ponytail();
  r.grid = {.rows = 6, .across = 3, .separate = true};
  r.layers = 12;
  r.tie = {.lift = 0.006f, .length = 0.30f, .radius = 0.030f, .waist = 0.010f, .tip = 0.45f};
  r.whole_tail = true;
  r.hair = {{Kind::kLength, 1.0f, 0, 0, 0.06f},
            {Kind::kBraid, 0.55f, 8, 0.4f, 0.12f},
            {Kind::kNoise, 0.001f, 5, 0.1f, 0.2f},
            {Kind::kFrizz, 0.0012f, 6, 0.1f, 1},
            {Kind::kTaper, 0.5f, 0, 0.6f, 0.4f}};
  return r;
}

Recipe recipe_of(HairMeshStyle style) {
  switch (style) {
    case HairMeshStyle::kBob: return bob();
    case HairMeshStyle::kWavy: return long_wavy();
    case HairMeshStyle::kCurls: return curls();
    case HairMeshStyle::kAfro: return afro();
    case HairMeshStyle::kPonytail: return ponytail();
    case HairMeshStyle::kBraid: return braid();
  }
  return {};
}

void apply(const HairMeshSettings& settings, Recipe& r) {
  r.grid.parting_x = r.grid.parted ? settings.parting : 0;
  r.fall.parting_x = settings.parting;
  // Longer hair is cut lower by as much as the longest gains.
  const float more = r.fall.length * (settings.length - 1);
  r.fall.length += more, r.fall.cut_front -= more, r.fall.cut_back -= more;
  r.tie.length *= settings.length;
  const float ball = 0.095f;  // of a ball's radius the head
  r.ball_radius = r.ball_radius > 0 ? ball + (r.ball_radius - ball) * settings.length : 0;
}

class Maker {
 public:
  Maker(const HairMeshSettings& settings, const Recipe& recipe)
      : s_(settings), r_(recipe), grid_(make_scalp_grid(recipe.grid)) {}

  HairMesh make() {
    add_columns();
    add_bundles();
    mesh_.styles = {r_.hair, r_.stray};
    mesh_.width = s_.width;
    mesh_.comment = fmt::format("{}, seed {}", hair_mesh_style_names()[static_cast<std::size_t>(s_.style)], s_.seed);
    return std::move(mesh_);
  }

 private:
  void add_columns() {
    const std::size_t layers = static_cast<std::size_t>(r_.layers), count = grid_.columns.size();
    mesh_.positions.resize(count * layers), mesh_.uvw.resize(count * layers);
    for (std::size_t c = 0; c <= count; ++c) mesh_.column_offsets.push_back(static_cast<std::uint32_t>(c * layers));
    parallel_for(count, 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) {
        const std::vector<Vec3> points = column_points(c);
        const Vec2 uv = head_uv(grid_.columns[c].root);
        for (std::size_t k = 0; k < layers; ++k) {
          mesh_.positions[c * layers + k] = points[k];
          mesh_.uvw[c * layers + k] = {saturate(uv.x), saturate(uv.y), static_cast<float>(k) / static_cast<float>(layers - 1)};
        }
      }
    });
  }

  std::vector<Vec3> column_points(std::size_t c) const {
    const ScalpColumn& column = grid_.columns[c];
    if (r_.ball_radius > 0) return resample(ball_path(column, r_.ball_radius), r_.layers, r_.denser_at_root);
    if (r_.layers_to_tie == 0) return resample(fall_path(column, r_.fall), r_.layers, r_.denser_at_root);
    const TiedPath path = tied_path(column, r_.tie, place_in_tail(c));
    std::vector<Vec3> points = resample(path.to_tie, r_.layers_to_tie, 0);
    const std::vector<Vec3> tail = resample(path.tail, r_.layers - r_.layers_to_tie + 1, 0);
    points.insert(points.end(), tail.begin() + 1, tail.end());
    return points;
  }

  /// In a whole tail the four columns of a bundle, which stand one after another, go to its four corners.
  Vec2 place_in_tail(std::size_t c) const {
    constexpr Vec2 kCorners[4] = {{-0.8f, -0.6f}, {0.8f, -0.6f}, {0.8f, 0.6f}, {-0.8f, 0.6f}};
    if (!r_.whole_tail) return tail_place(grid_.columns[c].root);
    for (const auto& quad : grid_.quads)
      for (std::size_t i = 0; i < 4; ++i)
        if (quad[i] == c) return kCorners[i];
    return {};
  }

  void add_bundles() {
    std::vector<double> area;
    for (const auto& quad : grid_.quads) area.push_back(quad_area(quad));
    const auto due = static_cast<std::uint32_t>(std::lround(static_cast<double>(r_.strays) * s_.strands));
    const std::uint32_t strays = std::max(due, static_cast<std::uint32_t>(grid_.quads.size()));
    add_bundles(area, s_.strands - strays, 0);
    add_bundles(area, strays, 1);
  }

  double quad_area(const std::array<std::uint32_t, 4>& q) const {
    const auto root = [&](std::size_t i) { return grid_.columns[q[i]].root; };
    return 0.5 * static_cast<double>(length(cross(root(2) - root(0), root(3) - root(1))));
  }

  /// Shares `strands` out by area, so that rounding errors never add up; every bundle has one at least.
  void add_bundles(const std::vector<double>& area, std::uint32_t strands, std::uint32_t style) {
    const double total = std::accumulate(area.begin(), area.end(), 0.);
    const double to_share = strands - static_cast<double>(area.size());
    double so_far = 0;
    std::uint32_t given = 0;
    for (std::size_t q = 0; q < area.size(); ++q) {
      so_far += area[q];
      const auto due = static_cast<std::uint32_t>(std::lround(to_share * so_far / total)) + static_cast<std::uint32_t>(q) + 1;
      const RandomBits bits = pcg4d(s_.seed, static_cast<std::uint32_t>(q), style, 0x62756e64u);
      mesh_.bundles.push_back({grid_.quads[q], due - given, style, bits.x});
      given = due;
    }
  }

  const HairMeshSettings& s_;
  const Recipe& r_;
  ScalpGrid grid_;
  HairMesh mesh_;
};

template <class T>
void check_range(const char* name, T value, T low, T high) {
  if (!(value >= low && value <= high))
    throw Error("hair mesh", name, fmt::format("{} is outside {} … {}", value, low, high), "choose a value in that range");
}

}  // namespace

HairMesh make_hair_mesh(const HairMeshSettings& settings, const Progress& progress) {
  check_range("strands", settings.strands, 1000u, 1000000u);
  check_range("width", settings.width, 0.f, 0.1f);
  check_range("length", settings.length, 0.5f, 1.5f);
  check_range("parting", settings.parting, -0.05f, 0.05f);
  Recipe recipe = recipe_of(settings.style);
  apply(settings, recipe);
  HairMesh mesh = Maker(settings, recipe).make();
  if (settings.occlusion) bake_occlusion(mesh, progress);
  return mesh;
}

}  // namespace pelage
