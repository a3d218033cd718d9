#include "raster/deferred.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "assemble/assemble.h"
#include "assemble/strand_block.h"
#include "core/rng.h"
#include "frame/camera_view.h"
#include "kernel/scalar.h"
#include "kit/hair_mesh_scene.h"
#include "lod/bundle_lod.h"
#include "raster/raster.h"

namespace pelage {
namespace {

using testing::deferred_grooms;
using testing::every_operator;
using testing::hair_mesh_scene;
using testing::small_hair_mesh;

struct Drawn {
  DeferredBuffer buffer;
  LodSelection selection;
  CameraView view;
  std::uint64_t segments = 0;
};

Drawn draw(const Scene& scene, int width, int height, const DeferredLayers& layers, const Buffer<float>& opaque = {}) {
  Drawn d;
  d.view = make_camera_view(scene.camera, width, height);
  const std::vector<DeferredGroom> grooms = deferred_grooms(scene);
  d.selection = select_lod(scene, grooms, std::span(&d.view, 1));
  place_deferred(scene, grooms, d.selection, 0, d.view, d.buffer);
  const DeferredTarget target{d.view, opaque, d.buffer};
  d.segments = raster_hair_meshes(scene, grooms, d.selection, std::span(&target, 1), layers);
  return d;
}

constexpr DeferredLayers kBoth{.center = true, .conservative = true};

// ---------------------------------------------------------------------------------------------------------------------
// The pixels that a segment touches, against polygons clipped in doubles.

struct D2 {
  double x, y;
};

/// Keeps a·x + b·y + c ≥ 0.
std::vector<D2> clipped(const std::vector<D2>& polygon, double a, double b, double c) {
  std::vector<D2> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const D2 p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    const double side_p = a * p.x + b * p.y + c, side_q = a * q.x + b * q.y + c;
    if (side_p >= 0) kept.push_back(p);
    if ((side_p >= 0) != (side_q >= 0)) {
      const double t = side_p / (side_p - side_q);
      kept.push_back({p.x + (q.x - p.x) * t, p.y + (q.y - p.y) * t});
    }
  }
  return kept;
}

/// A segment along its major axis: from (u0, v0) to (u1, v1), u0 ≤ u1, half heights h0 and h1.
struct OracleBand {
  double u0, v0, h0, u1, v1, h1;
  /// Whether it meets the square around a pixel that is `grow` larger on every side.
  bool meets(int column, int row, double grow) const {
    const std::vector<D2> band{{u0, v0 - h0}, {u1, v1 - h1}, {u1, v1 + h1}, {u0, v0 + h0}};
    std::vector<D2> p = clipped(band, 1, 0, grow - column);
    if (!p.empty()) p = clipped(p, -1, 0, column + 1 + grow);
    if (!p.empty()) p = clipped(p, 0, 1, grow - row);
    if (!p.empty()) p = clipped(p, 0, -1, row + 1 + grow);
    return !p.empty();
  }
};

TEST(DeferredRaster, AMillionSegmentsTouchThePixelsThatAClipperSays) {
  constexpr double kRounding = 2e-4;  // pixels; coordinates are below 64, whose floats are 4e-6 apart
  int pixels = 0, doubtful = 0;
  for (std::uint32_t i = 0; i < 1000000; ++i) {
    Rng rng(99, i);
    const float size = std::pow(10.f, -2 + 3 * rng.uniform());  // 0.01 to 10 pixels long
    const Vec2 a(16 + 32 * rng.uniform(), 16 + 32 * rng.uniform());
    const Vec2 b(a.x + size * (2 * rng.uniform() - 1), a.y + size * (2 * rng.uniform() - 1));
    const float radius = std::pow(10.f, -2.5f + 2.5f * rng.uniform());
    const kernel::RasterBand band = kernel::raster_band(a, b, radius, 0.8f * radius, 1, 1, {1, 0}, {1, 0});
    const double stretch = std::sqrt(1 + static_cast<double>(band.slope) * band.slope);
    const bool forward = band.end_u >= band.u;
    const auto end = [&](bool start) {
      return start ? std::array<double, 3>{band.u, band.v, radius * stretch}
                   : std::array<double, 3>{band.end_u, band.end_v, 0.8f * radius * stretch};
    };
    const auto lo = end(forward), hi = end(!forward);
    const OracleBand oracle{lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]};
    const Vec2 columns = kernel::raster_touched_columns(band);
    for (int column = static_cast<int>(columns.x) - 1; column <= static_cast<int>(columns.y) + 1; ++column) {
      const auto c = static_cast<float>(column);
      const bool inside = c >= columns.x && c <= columns.y;
      const Vec2 rows = inside ? kernel::raster_touched_rows(band, c) : Vec2(1, 0);
      const double low = std::min(lo[1] - lo[2], hi[1] - hi[2]), high = std::max(lo[1] + lo[2], hi[1] + hi[2]);
      for (int row = static_cast<int>(low) - 1; row <= static_cast<int>(high) + 1; ++row) {
        const bool taken = static_cast<float>(row) >= rows.x && static_cast<float>(row) <= rows.y;
        const bool sure = oracle.meets(column, row, -kRounding), possible = oracle.meets(column, row, kRounding);
        ASSERT_TRUE(taken || !sure) << "segment " << i << " misses pixel " << column << ", " << row;
        ASSERT_TRUE(!taken || possible) << "segment " << i << " takes pixel " << column << ", " << row;
        pixels += taken, doubtful += possible && !sure;
      }
    }
  }
  EXPECT_GT(pixels, 3000000);
  EXPECT_LT(doubtful, pixels / 200);
}

// ---------------------------------------------------------------------------------------------------------------------
// The layers, against a plain walk over every pixel of a small picture.

struct PlainLayers {
  std::vector<PixelKey> center, conservative;
};

void draw_plainly(const ScreenBlock& block, const DeferredBuffer& like, PlainLayers& out) {
  const int width = like.view.width, height = like.view.height;
  for (std::size_t j = 0; j + block.stride < block.count; ++j) {
    if (block.id[j] == ScreenBlock::kNoSegment) continue;
    const std::size_t k = j + block.stride;
    const kernel::RasterBand band =
        kernel::raster_band({block.x[j], block.y[j]}, {block.x[k], block.y[k]}, block.radius[j], block.radius[k],
                            block.depth[j], block.depth[k], {block.cap_x[j], block.cap_y[j]}, {block.cap_x[k], block.cap_y[k]});
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const float column = static_cast<float>(band.x_major ? x : y), row = static_cast<float>(band.x_major ? y : x);
        const float u = column + 0.5f, s = u - band.u;
        const float middle = kernel::raster_band_center(band, s), half = kernel::raster_band_half(band, s);
        const bool covered = row >= kernel::raster_first_row(middle, half, 0.5f) &&
                             kernel::raster_row_covered(row, 0.5f, middle, half) &&
                             kernel::raster_between_caps(band, u, row + 0.5f) && kernel::raster_between_ends(band, u);
        const Vec2 columns = kernel::raster_touched_columns(band), rows = kernel::raster_touched_rows(band, column);
        const bool touched = column >= columns.x && column <= columns.y && row >= rows.x && row <= rows.y;
        if (!covered && !touched) continue;
        const float du = band.end_u - band.u;
        const std::size_t end = (du < 0 ? -s : s) > std::fabs(du) * 0.5f ? k : j;
        const auto level = static_cast<PixelKey>(
            kernel::raster_depth_level(kernel::raster_band_depth(band, s), like.range.near_end, like.range.levels_per_metre()));
        const PixelKey key = level << 40 | static_cast<PixelKey>(block.payload_high[end]) << 32 | block.payload_low[end];
        const auto at = static_cast<std::size_t>(y * width + x);
        if (covered) out.center[at] = std::min(out.center[at], key);
        out.conservative[at] = std::min(out.conservative[at], key);
      }
  }
}

PlainLayers plain_layers(const Scene& scene, const Drawn& d) {
  const std::vector<DeferredGroom> grooms = deferred_grooms(scene);
  PlainLayers plain;
  plain.center.assign(d.buffer.center.size(), kEmptyPixel), plain.conservative = plain.center;
  StrandGroup group;
  StrandBlock block;
  for (const BundleDraw& b : d.selection.bundles)
    for (std::uint32_t s = 0; s < b.strands; s += 16) {
      make_strands_scalar(grooms[b.groom].mesh->cages[b.bundle], s, std::min(16u, b.strands - s), b.points, group);
      const GroomInstance& groom = scene.grooms[grooms[b.groom].groom];
      pack_group(group, {groom.transform, uv_cells(b.groom, grooms.size())}, block);
      draw_plainly(project_group(group, make_project_job(d.buffer.view, groom), b.width_scale, block), d.buffer, plain);
    }
  return plain;
}

bool same(const Buffer<PixelKey>& a, const std::vector<PixelKey>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}

TEST(DeferredRaster, DrawsWhatAPlainWalkDraws) {
  for (const float width : {5e-5f, 1e-3f, 8e-3f}) {  // up to some eight pixels
    HairMesh mesh = small_hair_mesh(every_operator(), 2, 5, 9);
    mesh.width = width;
    Scene scene = hair_mesh_scene(mesh);
    scene.settings.swr.points = 17;
    const Drawn d = draw(scene, 89, 57, kBoth);
    const PlainLayers plain = plain_layers(scene, d);
    EXPECT_GT(std::count_if(plain.center.begin(), plain.center.end(), deferred::is_strand), width > 1e-4f ? 150 : 5);
    EXPECT_TRUE(same(d.buffer.center, plain.center)) << width;
    EXPECT_TRUE(same(d.buffer.conservative, plain.conservative)) << width;
    for (std::size_t i = 0; i < plain.center.size(); ++i)
      EXPECT_TRUE(!deferred::is_strand(d.buffer.center[i]) || d.buffer.conservative[i] <= d.buffer.center[i]);
    // Without the conservative layer the walk skips columns; the center layer is the same.
    EXPECT_TRUE(same(draw(scene, 89, 57, {}).buffer.center, plain.center)) << width;
  }
}

TEST(DeferredRaster, DrawsWhatAPlainWalkDrawsFromWithinTheHair) {
  Scene scene = hair_mesh_scene(small_hair_mesh(every_operator(), 2, 5, 9));
  scene.settings.swr.points = 17;
  scene.camera.eye = {0.02f, 0.08f, 0.02f}, scene.camera.target = {0.1f, 0.1f, 0}, scene.camera.near_plane = 0.01f;
  const Drawn d = draw(scene, 61, 47, kBoth);
  const PlainLayers plain = plain_layers(scene, d);
  EXPECT_GT(std::count_if(plain.center.begin(), plain.center.end(), deferred::is_strand), 5);
  EXPECT_TRUE(same(d.buffer.center, plain.center));
  EXPECT_TRUE(same(d.buffer.conservative, plain.conservative));
}

// Strands that are made once and seen from all around, from within the hair, in part, and not at all.
TEST(DeferredRaster, EachOfManyViewsIsWhatItIsAlone) {
  Scene scene = hair_mesh_scene(small_hair_mesh(every_operator(), 2, 5, 40));
  scene.grooms.push_back(scene.grooms[0]);
  scene.grooms[1].transform.m[0][3] = 0.15f;
  scene.settings.swr.points = 33;
  std::vector<CameraView> pictures{make_camera_view(scene.camera, 200, 150)};
  scene.camera.eye.x -= 0.4f;
  pictures.push_back(make_camera_view(scene.camera, 97, 120));
  Camera other = scene.camera;
  other.eye = {0.02f, 0.08f, 0.02f}, other.target = {0.1f, 0.1f, 0}, other.near_plane = 0.01f;
  pictures.push_back(make_camera_view(other, 61, 47));
  other.eye = {0.25f, 0.1f, 0.5f}, other.target = {0.25f, 0.1f, 0}, other.fov_y = 0.4f;
  pictures.push_back(make_camera_view(other, 50, 200));
  other.target.z = 1;
  pictures.push_back(make_camera_view(other, 30, 20));

  const std::vector<DeferredGroom> grooms = deferred_grooms(scene);
  const LodSelection selection = select_lod(scene, grooms, pictures);
  std::vector<DeferredBuffer> together(pictures.size());
  std::vector<DeferredTarget> targets;
  const Buffer<float> nothing;
  for (std::size_t v = 0; v < pictures.size(); ++v) {
    place_deferred(scene, grooms, selection, v, pictures[v], together[v]);
    targets.push_back({pictures[v], nothing, together[v]});
  }
  const DeferredLayers layers{.center = true, .conservative = true, .samples = 4, .coverage = true};
  raster_hair_meshes(scene, grooms, selection, targets, layers);
  for (std::size_t v = 0; v < pictures.size(); ++v) {
    LodSelection own;
    for (BundleDraw bundle : selection.bundles) {
      if (!(bundle.views >> v & 1)) continue;
      bundle.views = 1;
      own.bundles.push_back(bundle), own.strands += bundle.strands, own.points += bundle.strands * bundle.points;
    }
    DeferredBuffer alone;
    place_deferred(scene, grooms, own, 0, pictures[v], alone);
    const DeferredTarget target{pictures[v], nothing, alone};
    raster_hair_meshes(scene, grooms, own, std::span(&target, 1), layers);
    const auto same = [](const auto& a, const auto& b) {
      return a.size() == b.size() && (a.size() == 0 || std::memcmp(a.data(), b.data(), a.bytes()) == 0);
    };
    EXPECT_EQ(together[v].range.near_end, alone.range.near_end) << v;
    EXPECT_TRUE(same(together[v].center, alone.center)) << v;
    EXPECT_TRUE(same(together[v].conservative, alone.conservative)) << v;
    EXPECT_TRUE(same(together[v].sample_keys, alone.sample_keys)) << v;
    EXPECT_TRUE(same(together[v].coverage, alone.coverage)) << v;
    const auto strands = std::count_if(alone.center.begin(), alone.center.end(), deferred::is_strand);
    if (v + 1 < pictures.size()) EXPECT_GT(strands, 50) << v;
    else EXPECT_EQ(strands, 0);
  }
}

// Grooms one behind another: most of what the first one hides is not even made, and no pixel shows it.
TEST(DeferredRaster, HiddenStrandsAreLeftOutAndNothingElse) {
  HairMesh mesh = small_hair_mesh({}, 2, 5, 24);
  mesh.width = 0.02f;
  Scene scene = hair_mesh_scene(mesh);
  scene.camera.eye = {0.03f, 0.1f, 0.5f}, scene.camera.target = {0.03f, 0.1f, 0};
  scene.settings.swr.points = 9, scene.settings.swr.lod = false;
  // The large one leans toward the eye: it comes first, and small ones before its foot come later, but are seen.
  Affine& large = scene.grooms[0].transform;
  large.m[1][1] = large.m[2][2] = 0.5f, large.m[2][1] = 0.8660254f, large.m[1][2] = -0.8660254f;
  large.m[1][3] = 0.05f;
  for (const Vec3 place :
       {Vec3(0.0225f, 0.08f, -0.2f), Vec3(0.01f, 0.08f, -0.4f), Vec3(0.0225f, 0.04f, 0.06f), Vec3(-0.04f, 0.08f, -0.1f),
        Vec3(0.03f, 0.03f, 0.02f), Vec3(0, 0.05f, 0.04f), Vec3(0.02f, 0.06f, 0.02f), Vec3(0.02f, 0.07f, 0.05f)}) {
    scene.grooms.push_back(scene.grooms[0]);
    Affine& small = scene.grooms.back().transform;
    small = Affine();
    for (int axis = 0; axis < 3; ++axis) small.m[axis][axis] = 0.25f;
    small.m[0][3] = place.x, small.m[1][3] = place.y, small.m[2][3] = place.z;
  }
  const Drawn d = draw(scene, 160, 120, kBoth);
  EXPECT_LT(d.segments, 9 * (d.selection.points - d.selection.strands) / 10);
  const PlainLayers plain = plain_layers(scene, d);
  EXPECT_TRUE(same(d.buffer.center, plain.center));
  EXPECT_TRUE(same(d.buffer.conservative, plain.conservative));
  const auto samples_of = [&](DeferredLayers layers) { return draw(scene, 160, 120, layers); };
  const Drawn alone = samples_of({.center = false, .samples = 4}), all = samples_of({.center = true, .samples = 4});
  EXPECT_LT(alone.segments, all.segments) << "hidden in one layer is not hidden in both";
  EXPECT_EQ(std::memcmp(alone.buffer.sample_keys.data(), all.buffer.sample_keys.data(), all.buffer.sample_keys.bytes()), 0);
}

TEST(DeferredRaster, SameBitsForAnyThreadsAndInstructionSet) {
  const Scene scene = hair_mesh_scene(small_hair_mesh(every_operator()));
  const DeferredLayers layers{.center = true, .conservative = true, .samples = 8};
  const Drawn expected = draw(scene, 257, 89, layers);
  const auto same_as = [&](const Drawn& d) {
    const auto equal = [](const Buffer<PixelKey>& a, const Buffer<PixelKey>& b) {
      return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(PixelKey)) == 0;
    };
    return equal(d.buffer.center, expected.buffer.center) && equal(d.buffer.conservative, expected.buffer.conservative) &&
           equal(d.buffer.sample_keys, expected.buffer.sample_keys);
  };
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    EXPECT_TRUE(same_as(draw(scene, 257, 89, layers))) << threads;
  }
  set_thread_count(0);
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    EXPECT_TRUE(same_as(draw(scene, 257, 89, layers))) << isa;
  }
  set_isa("");
}

// What a pixel tells is what the strand there is.
TEST(DeferredRaster, PixelsHoldTheStrandThatTheyShow) {
  HairMesh mesh = small_hair_mesh({}, 1, 4, 1);
  mesh.width = 0.004f;
  const Scene scene = hair_mesh_scene(mesh);
  const Drawn d = draw(scene, 200, 150, {});
  const StrandSet strand = expand(mesh, {.points = 127});
  int checked = 0;
  for (int y = 0; y < d.buffer.view.height; ++y)
    for (int x = 0; x < d.buffer.view.width; ++x) {
      const PixelKey key = d.buffer.center[static_cast<std::size_t>(y * d.buffer.view.width + x)];
      if (!deferred::is_strand(key)) continue;
      const float z = d.buffer.range.metres(deferred::depth_level(key)), scale = z / d.buffer.view.focal;
      const Vec3 place =
          transform_point(d.buffer.view.camera_to_world, {(static_cast<float>(x) + 0.5f - d.buffer.view.center_x) * scale,
                                                          (static_cast<float>(y) + 0.5f - d.buffer.view.center_y) * scale, z});
      std::size_t nearest = 1;
      for (std::size_t i = 1; i + 1 < strand.points.size(); ++i)
        if (length(strand.points[i] - place) < length(strand.points[nearest] - place)) nearest = i;
      EXPECT_LT(length(strand.points[nearest] - place), 0.0035f);
      const Vec3 along = normalize(strand.points[nearest + 1] - strand.points[nearest - 1]);
      EXPECT_GT(dot(along, deferred::tangent(key)), std::cos(0.05f));
      EXPECT_NEAR(static_cast<float>(deferred::w_cell(key)) + 0.5f, 64 * static_cast<float>(nearest) / 126, 1.5f);
      EXPECT_EQ(deferred::u_cell(key), static_cast<std::uint32_t>(64 * strand.root_uv[0].x));
      EXPECT_EQ(deferred::v_cell(key), static_cast<std::uint32_t>(64 * strand.root_uv[0].y));
      ++checked;
    }
  EXPECT_GT(checked, 100);
}

TEST(DeferredRaster, OpaqueDepthHidesWhatLiesBehind) {
  const Scene scene = hair_mesh_scene(small_hair_mesh(every_operator()));
  Buffer<float> opaque(120 * 90 * 4);
  for (std::size_t i = 0; i < opaque.size(); ++i) opaque[i] = i / 4 % 120 < 60 ? 0.3f : i % 4 < 2 ? 0.3f : INFINITY;
  const DeferredLayers layers{.center = true, .conservative = true, .samples = 4};
  const Drawn open = draw(scene, 120, 90, layers), hidden = draw(scene, 120, 90, layers, opaque);
  const int width = open.buffer.view.width;
  int before = 0;
  for (std::size_t p = 0; p < open.buffer.center.size(); ++p) {
    const bool left = static_cast<int>(p) % width + open.buffer.left < 60;
    EXPECT_EQ(hidden.buffer.center[p], left ? kEmptyPixel : open.buffer.center[p]);
    EXPECT_EQ(hidden.buffer.conservative[p], left ? kEmptyPixel : open.buffer.conservative[p]);
    for (std::size_t s = 0; s < 4; ++s)
      EXPECT_EQ(hidden.buffer.sample_keys[p * 4 + s], left || s < 2 ? kEmptyPixel : open.buffer.sample_keys[p * 4 + s]);
    before += !left && deferred::is_strand(open.buffer.conservative[p]);
  }
  EXPECT_GT(before, 500);
}

// A wall through the hair hides what is behind it, wherever it stands: strands before it stay, and behind it fewer are made.
TEST(DeferredRaster, AWallLeavesWhatStandsBeforeIt) {
  const Scene scene = hair_mesh_scene(small_hair_mesh(every_operator()));
  const DeferredLayers layers{.center = true, .conservative = true};
  const Drawn open = draw(scene, 120, 90, layers);
  const DepthRange& range = open.buffer.range;
  std::uint64_t fewest = open.segments;
  int kept = 0;
  for (int i = 0; i < 8; ++i) {
    const float wall = range.near_end + (range.far_end - range.near_end) * static_cast<float>(i) / 8;
    Buffer<float> opaque(120 * 90);
    opaque.fill(wall);
    const Drawn d = draw(scene, 120, 90, layers, opaque);
    const auto level = static_cast<std::uint32_t>(kernel::raster_depth_level(wall, range.near_end, range.levels_per_metre()));
    for (std::size_t p = 0; p < open.buffer.center.size(); ++p) {
      const PixelKey key = open.buffer.center[p];
      const bool before = deferred::is_strand(key) && deferred::depth_level(key) < level;
      ASSERT_EQ(d.buffer.center[p], before ? key : kEmptyPixel) << wall;
      kept += before;
    }
    fewest = std::min(fewest, d.segments);
  }
  EXPECT_GT(kept, 500);
  EXPECT_LE(fewest, open.segments / 4) << "the first wall stands before all bundles but the nearest";
}

// The area of strands that are made on the fly is that of the same strands from memory.
TEST(DeferredRaster, CoversWhatItsStrandsCover) {
  Scene scene = hair_mesh_scene(small_hair_mesh(every_operator(), 2, 5, 100));
  Buffer<float> opaque(120 * 90);
  for (std::size_t i = 0; i < opaque.size(); ++i) opaque[i] = i % 120 < 60 ? 0.6f : INFINITY;
  const Drawn d = draw(scene, 120, 90, {.center = true, .coverage = true}, opaque);
  expand_hair_meshes(scene);
  scene.settings.subdivisions = 1;
  GBuffer strands;
  strands.opaque_depth.resize(opaque.size());
  std::copy(opaque.begin(), opaque.end(), strands.opaque_depth.begin());
  raster_strands(scene, d.view, number_segments(scene, d.view), {.center = false, .coverage = true}, strands);
  double sum = 0, expected = 0;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 120; ++x) {
      const auto at = static_cast<std::size_t>(y * 120 + x);
      const int column = x - d.buffer.left, row = y - d.buffer.top, width = d.buffer.view.width;
      const bool inside = column >= 0 && row >= 0 && column < width && row < d.buffer.view.height;
      const float ours = inside ? d.buffer.coverage[static_cast<std::size_t>(row * width + column)] : 0;
      EXPECT_NEAR(ours, analytic_coverage(strands, at), 1e-3f) << x << ", " << y;
      sum += ours, expected += analytic_coverage(strands, at);
    }
  EXPECT_GT(expected, 50);
  EXPECT_NEAR(sum, expected, 1e-3 * expected);
}

TEST(DeferredRaster, GroomsHaveCellsOfTheirOwn) {
  Scene scene = hair_mesh_scene(small_hair_mesh({}));
  scene.grooms.push_back(scene.grooms[0]);
  scene.grooms[1].transform.m[0][3] = 0.15f;
  const Drawn d = draw(scene, 200, 100, kBoth);
  const UvCells a = uv_cells(0, 2), b = uv_cells(1, 2);
  int of_a = 0, of_b = 0;
  for (const PixelKey key : d.buffer.conservative) {
    if (!deferred::is_strand(key)) continue;
    const auto in = [&](const UvCells& c) {
      return deferred::u_cell(key) - c.first_u < c.count && deferred::v_cell(key) - c.first_v < c.count;
    };
    EXPECT_NE(in(a), in(b));
    of_a += in(a), of_b += in(b);
  }
  EXPECT_GT(of_a, 500);
  EXPECT_GT(of_b, 500);
}

TEST(DeferredPacking, TangentsTurnByNoMoreThanTheirBound) {
  float worst = 0;
  for (std::uint32_t i = 0; i < 200000; ++i) {
    Rng rng(5, i);
    const float z = 2 * rng.uniform() - 1, phi = 6.2831853f * rng.uniform(), r = std::sqrt(1 - z * z);
    const Vec3 d(r * std::cos(phi), r * std::sin(phi), z);
    const Vec2 oct = kernel::raster_octahedral(d);
    const Vec3 back = kernel::raster_from_octahedral({kernel::raster_tangent_of_level(kernel::raster_tangent_level(oct.x)),
                                                      kernel::raster_tangent_of_level(kernel::raster_tangent_level(oct.y))});
    worst = std::max(worst, length(cross(d, back)));
    ASSERT_GT(dot(d, back), 0.9f);
  }
  EXPECT_LT(worst, kernel::kRasterTangentMaxError);
  EXPECT_GT(worst, 0.5f * kernel::kRasterTangentMaxError);
}

TEST(DeferredPacking, AllGroomsFitIntoTheCells) {
  for (const std::size_t grooms : {std::size_t{1}, std::size_t{2}, std::size_t{5}, std::size_t{100}, std::size_t{4096}})
    for (std::size_t i = 0; i < grooms; ++i) {
      const UvCells c = uv_cells(i, grooms);
      EXPECT_GE(c.count, 1u);
      EXPECT_LE(c.first_u + c.count, kUvCells);
      EXPECT_LE(c.first_v + c.count, kUvCells);
    }
}

}  // namespace
}  // namespace pelage
