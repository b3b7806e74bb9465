#include "gl/reconstructor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "expect_error.h"
#include "first_frame.h"
#include "gl/context.h"
#include "picture_difference.h"

namespace diminish {
namespace {

struct Difference {
  std::size_t pixels = 0, drawn = 0;
  std::size_t other_alpha = 0, other_source = 0;
  std::size_t other_color = 0;  ///< by more than two levels
  double worst_depth = 0;       ///< relative, where the source is the same
};

Difference compare(const Reconstruction& a, const Reconstruction& b) {
  Difference difference;
  for (int y = 0; y < a.color.height(); ++y) {
    for (int x = 0; x < a.color.width(); ++x) {
      const Bgra& p = a.color(x, y);
      const Bgra& q = b.color(x, y);
      if (a.region.contains(x, y) && a.region.keeps(x, y)) ++difference.pixels;
      if (p.a != q.a) ++difference.other_alpha;
      if (p.a != 255 || q.a != 255) continue;
      ++difference.drawn;
      if (testing::difference(p, q) > 2) ++difference.other_color;
      if (a.source(x, y) != b.source(x, y)) {
        ++difference.other_source;
      } else {
        const double off = std::abs(double{a.depth_m(x, y)} / b.depth_m(x, y) - 1);
        // Written so that NaN counts.
        if (!(off <= difference.worst_depth)) difference.worst_depth = off;
      }
    }
  }
  return difference;
}

struct Case {
  const char* recording;
  const char* backend;
};

class GlOnRecordings : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Recordings, GlOnRecordings,
                         ::testing::Values(Case{"calendar", "gl"}, Case{"ball", "gl"},
                                           Case{"workbench", "gl"}, Case{"calendar", "gl_geometry"},
                                           Case{"ball", "gl_geometry"},
                                           Case{"workbench", "gl_geometry"}),
                         [](const auto& test) {
                           return std::string(test.param.recording) + "_" + test.param.backend;
                         });

// Whole views and parts, with masks and without, one camera and several.
TEST_P(GlOnRecordings, DrawsWhatThePlainVersionDraws) {
  testing::FirstFrame first(GetParam().recording);
  first.options.merge_cameras = "choose";
  const auto on_gpu = Registry<Reconstructor>::get(GetParam().backend)(first.rig());
  const auto plain = Registry<Reconstructor>::get("reference")(first.rig());
  Reconstruction a;
  Reconstruction b;
  for (const bool masked : {false, true}) {
    if (masked) first.mask_parts();
    for (const TiledRegion& region :
         {first.whole_view(), TiledRegion(Rect{300, 200, 421, 333}), first.tiled_part()}) {
      first.reconstruct(*on_gpu, region, a);
      first.reconstruct(*plain, region, b);
      ASSERT_EQ(a.region, region);
      const Difference difference = compare(a, b);
      RecordProperty("other_alpha", static_cast<int>(difference.other_alpha));
      RecordProperty("other_color", static_cast<int>(difference.other_color));
      EXPECT_GT(difference.drawn, difference.pixels / 4);
      EXPECT_LE(difference.other_alpha * 1000, difference.pixels);
      EXPECT_LE(difference.other_color * 1000, difference.drawn);
      EXPECT_LE(difference.other_source * 1000, difference.drawn);
      EXPECT_LT(difference.worst_depth, 0.05);
    }
  }
  ASSERT_FALSE(on_gpu->gpu_passes().empty());
  EXPECT_FALSE(on_gpu->device().empty());
}

// Which triangle is seen does not depend on the order in which they are drawn.
TEST_P(GlOnRecordings, DrawsTheSameEveryTime) {
  const testing::FirstFrame first(GetParam().recording);
  const auto on_gpu = Registry<Reconstructor>::get(GetParam().backend)(first.rig());
  Reconstruction a;
  Reconstruction b;
  first.reconstruct(*on_gpu, first.whole_view(), a);
  first.reconstruct(*on_gpu, first.whole_view(), b);
  EXPECT_EQ(a.color, b.color);
  EXPECT_EQ(a.depth_m, b.depth_m);
  EXPECT_EQ(a.source, b.source);
}

// A camera so near that each cell covers hundreds of pixels: triangles that work groups share, and
// products of coordinates that 32 bits do not hold.
TEST(GlReconstructor, DrawsLargeCells) {
  const testing::AnalyticScene scene;
  testing::AnalyticFrame frame(scene, {Eigen::Vector3d(-0.45, 0.3, 0.9)});
  const OcclusionMasks masks = testing::empty_masks(frame.rig);
  const Rect region = frame.rig.color.bounds();
  for (const double magnification : {12.0, 300.0}) {
    Rig rig = frame.rig;
    rig.color.fx *= magnification;
    rig.color.fy *= magnification;
    Reconstruction a;
    Reconstruction b;
    const DepthImages depths = testing::depths_of(frame.frame);
    Registry<Reconstructor>::get("gl")(rig)->reconstruct(frame.frame, depths, frame.poses, masks,
                                                         region, {}, a);
    Registry<Reconstructor>::get("reference")(rig)->reconstruct(frame.frame, depths, frame.poses,
                                                                masks, region, {}, b);
    const Difference difference = compare(a, b);
    EXPECT_GT(difference.drawn, difference.pixels / 2) << magnification;
    EXPECT_LE(difference.other_alpha * 1000, difference.pixels) << magnification;
    EXPECT_LE(difference.other_color * 1000, difference.drawn) << magnification;
  }
}

TEST(GlProgram, ErrorsNameTheShadersFileAndLine) {
  const gl::Context context;
  const gl::Current current(context);
  // vertices.comp calls what the files before it define.
  const std::string message = error_of([] {
    gl::compute_program({"frame.glsl", "vertices.comp"});
  });
  EXPECT_THAT(message, ::testing::StartsWith("gl: shader vertices.comp:1"));
  EXPECT_THAT(message, ::testing::HasSubstr("find_vertex"));
  EXPECT_THAT(error_of([] { gl::compute_program({"none.comp"}); }),
              ::testing::HasSubstr("'none.comp'"));
}

TEST(GlContext, FailedCallsAreErrorsThatSayWhereAndOnWhat) {
  const gl::Context context;
  const gl::Current current(context);
  EXPECT_NO_THROW(context.check("nothing"));
  glBindBuffer(GL_TEXTURE_2D, 0);
  const std::string message = error_of([&] { context.check("a test"); });
  EXPECT_THAT(message, ::testing::StartsWith("gl: a test: GL_INVALID_ENUM"));
  EXPECT_THAT(message, ::testing::HasSubstr(context.driver().name));
  EXPECT_NO_THROW(context.check("reported once"));
}

}  // namespace
}  // namespace diminish
