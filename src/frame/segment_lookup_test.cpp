// Ids back to places, and pixels back to t.
#include "frame/segment_lookup.h"

#include <gtest/gtest.h>

#include "assemble/assemble.h"
#include "frame/camera_view.h"
#include "raster/test_scene.h"

namespace pelage {
namespace {

TEST(SegmentLookup, FindsWhatAssembleNumbered) {
  Scene scene = test::scene_of(test::helices(7, 13));
  scene.grooms.push_back(test::instance(test::helices(5, 16)));
  StrandSet bezier = test::helices(3, 7);
  bezier.basis = CurveBasis::kBezier;
  scene.grooms.push_back(test::instance(std::move(bezier)));
  scene.settings.subdivisions = 4;
  const CameraView view = make_camera_view(scene.camera, 100, 100);
  const SegmentNumbering numbering = number_segments(scene, view);
  for (std::size_t g = 0; g < scene.grooms.size(); ++g) {
    const AssembleJob job = make_assemble_job(scene, view, numbering, g);
    ScreenBlock block;
    const std::size_t strands = job.strands->strand_count();
    for (std::size_t s = 0; s < strands; ++s) {
      assemble_strands(job, s, s + 1, block);
      for (std::size_t j = 0; j + 1 < block.count; ++j) {
        const SegmentRef found = find_segment(scene, numbering, block.id[j]);
        ASSERT_EQ(found.groom, g);
        ASSERT_EQ(found.strand, s);
        ASSERT_EQ(found.span * 4 + found.k, j);
        const StrandSurface at = surface_at(scene, numbering, found, 0);
        const Vec2 seen = project(view, transform_point(view.world_to_camera, at.position));
        ASSERT_NEAR(seen.x, block.x[j], 1e-3f);
        ASSERT_NEAR(seen.y, block.y[j], 1e-3f);
        const Vec2 middle((block.x[j] + block.x[j + 1]) / 2, (block.y[j] + block.y[j + 1]) / 2);
        ASSERT_NEAR(locate_on_segment(scene, numbering, view, found, middle.x, middle.y), 0.5f, 0.05f);
      }
    }
  }
}

TEST(SegmentLookup, PlacesAreExactAtTheEnds) {
  const Scene scene = test::scene_of(test::strand({{0, 0, 0}, {1, 0, 0}, {1, 2, 0}}, 0.5f));
  const CameraView view = make_camera_view(scene.camera, 100, 100);
  const SegmentNumbering numbering = number_segments(scene, view);
  const StrandSurface tip = surface_at(scene, numbering, find_segment(scene, numbering, 1), 1);
  EXPECT_EQ(tip.position, Vec3(1, 2, 0));
  EXPECT_EQ(tip.tangent, Vec3(0, 1, 0));
  EXPECT_EQ(tip.u, 1);
  EXPECT_EQ(tip.width, 0.5f);
}

// Chords may err by 0.1 pixels, divided by the samples a pixel above 8; halving a chord quarters its error.
TEST(NumberSegments, ChordsAreFinerForManySamples) {
  Scene scene = test::scene_of(test::helices(7, 13));
  scene.settings.subdivisions = 0;
  const CameraView view = make_camera_view(scene.camera, 150, 150);
  const auto parts = [&](Method method, int samples) {
    scene.settings.method = method, scene.settings.samples = samples;
    return number_segments(scene, view).subdivisions[0];
  };
  const std::uint32_t few = parts(Method::kMsaa, 1);
  ASSERT_GE(few, 2u) << "a view that asks for chords";
  ASSERT_LE(4 * few, kMaxSubdivisions);
  EXPECT_EQ(parts(Method::kMsaa, 8), few);
  EXPECT_EQ(parts(Method::kSsaa, 8), few);
  EXPECT_EQ(parts(Method::kTaa, 512), few) << "does not read `samples`";
  for (const auto& [samples, finer] : {std::pair{32, 2u}, {128, 4u}}) {
    EXPECT_LE(parts(Method::kSsaa, samples), finer * few) << samples;
    EXPECT_GE(parts(Method::kSsaa, samples), finer * few - (finer - 1)) << samples;
  }
  EXPECT_GT(parts(Method::kMsaa, 16), few);
  EXPECT_EQ(parts(Method::kSsaa, 4096), kMaxSubdivisions);
}

}  // namespace
}  // namespace pelage
