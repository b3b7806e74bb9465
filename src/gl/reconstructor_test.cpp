#include "gl/reconstructor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "expect_error.h"
#include "first_frame.h"
#include "gl/context.h"
#include "mixed_color.h"
#include "picture_difference.h"

namespace diminish {
namespace {

struct Difference {
  std::size_t pixels = 0, drawn = 0;
  std::size_t other_alpha = 0;
  std::size_t other_source = 0;  ///< nor the same two, the other way round: equally trusted
  std::size_t other_color = 0;   ///< by more than two levels, once second views are mixed in
  std::size_t blended = 0;
  double worst_depth = 0;  ///< relative, where the source is the same
};

Difference compare(const Reconstruction& a, const Reconstruction& b) {
  Difference difference;
  for (int y = 0; y < a.color.height(); ++y) {
    for (int x = 0; x < a.color.width(); ++x) {
      const Bgra p = testing::mixed_color(a, x, y);
      const Bgra q = testing::mixed_color(b, x, y);
      if (a.region.contains(x, y) && a.region.keeps(x, y)) ++difference.pixels;
      if (p.a != q.a) ++difference.other_alpha;
      if (p.a != 255 || q.a != 255) continue;
      ++difference.drawn;
      if (testing::difference(p, q) > 2) ++difference.other_color;
      if (!a.second.share.empty() && a.second.share(x, y) > 0) ++difference.blended;
      if (a.source(x, y) != b.source(x, y)) {
        const bool same_two = !a.second.share.empty() && a.second.source(x, y) == b.source(x, y) &&
                              b.second.source(x, y) == a.source(x, y);
        difference.other_source += same_two ? 0U : 1U;
      } else {
        const double off = std::abs(double{a.depth_m(x, y)} / b.depth_m(x, y) - 1);
        // Written so that NaN counts.
        if (!(off <= difference.worst_depth)) difference.worst_depth = off;
      }
    }
  }
  return difference;
}

void expect_alike(const Difference& difference) {
  EXPECT_LE(difference.other_alpha * 1000, difference.pixels);
  EXPECT_LE(difference.other_color * 1000, difference.drawn);
  EXPECT_LE(difference.other_source * 1000, difference.drawn);
  EXPECT_LT(difference.worst_depth, 0.05);
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
  const bool several = first.rig().rgbd.size() > 1;
  for (const bool masked : {false, true}) {
    if (masked) first.mask_parts();
    for (const char* merge : {"blend", "choose"}) {
      first.options.merge_cameras = merge;
      for (const TiledRegion& region :
           {first.whole_view(), TiledRegion(Rect{300, 200, 421, 333}), first.tiled_part()}) {
        first.reconstruct(*on_gpu, region, a);
        first.reconstruct(*plain, region, b);
        ASSERT_EQ(a.region, region);
        const Difference difference = compare(a, b);
        RecordProperty("other_alpha", static_cast<int>(difference.other_alpha));
        RecordProperty("other_color", static_cast<int>(difference.other_color));
        EXPECT_GT(difference.drawn, difference.pixels / 4);
        expect_alike(difference);
        const bool blended = several && first.options.merge_cameras == "blend";
        EXPECT_EQ(a.second.share.empty(), !blended);
        EXPECT_EQ(difference.blended > difference.drawn / 10, blended);
      }
      if (!several) break;
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
  EXPECT_EQ(a.second.color, b.second.color);
  EXPECT_EQ(a.second.source, b.second.source);
  EXPECT_EQ(a.second.share, b.second.share);
}

/// Cameras on a circle around the wall and the box, and what each backend makes of them.
class ManyCameras : public ::testing::TestWithParam<const char*> {
 protected:
  static std::vector<Eigen::Vector3d> on_circle(std::size_t cameras) {
    std::vector<Eigen::Vector3d> eyes;
    for (std::size_t k = 0; k < cameras; ++k) {
      const double turn = 0.4 + 2 * static_cast<double>(k);
      eyes.emplace_back(0.4 * std::cos(turn), 0.4 * std::sin(turn), 0.9);
    }
    return eyes;
  }

  explicit ManyCameras(std::size_t cameras = 3)
      : scene(testing::AnalyticScene{}, on_circle(cameras)) {}

  void reconstruct(const char* backend, Reconstruction& reconstruction) const {
    const DepthImages depths = testing::depths_of(scene.frame);
    const OcclusionMasks masks = testing::empty_masks(scene.rig);
    Registry<Reconstructor>::get(backend)(scene.rig)->reconstruct(
        scene.frame, depths, scene.poses, masks, region, options, reconstruction);
  }
  /// The plain version takes other ones of cameras that are trusted equally.
  Difference beside_the_cpus() {
    reconstruct(GetParam(), result);
    reconstruct("cpu", expected);
    return compare(result, expected);
  }

  testing::AnalyticFrame scene;
  Options options;
  Rect region{13, 9, 275, 228};
  Reconstruction result, expected;
};

class ThreeCameras : public ManyCameras {};
INSTANTIATE_TEST_SUITE_P(Backends, ThreeCameras, ::testing::Values("gl", "gl_geometry"));

// What is left over from an object: strips in front of the wall, two depth pixels wide.
TEST_P(ThreeCameras, WithSlivers) {
  Reconstruction without;
  reconstruct("cpu", without);
  for (std::size_t k = 0; k < 2; ++k) {
    Image<std::uint16_t>& depth = scene.frame.rgbd[k].depth.own();
    for (int x = 30; x + 1 < depth.width(); x += 23) depth.fill({x, 60, 2, 90}, 7000);
  }
  options.merge_cameras = "choose";
  reconstruct("cpu", expected);
  const auto in_front = [&](const Reconstruction& reconstruction) {
    std::size_t pixels = 0;
    for (std::size_t i = 0; i < reconstruction.depth_m.size(); ++i) {
      const float z = reconstruction.depth_m.data()[i];
      pixels += z > 0 && z < without.depth_m.data()[i] - 0.1F ? 1U : 0U;
    }
    return pixels;
  };
  const std::size_t slivers = in_front(expected);
  EXPECT_GT(slivers, 1000U);

  options.merge_cameras = "blend";
  const Difference difference = beside_the_cpus();
  expect_alike(difference);
  EXPECT_GT(difference.drawn, difference.pixels / 2);
  EXPECT_GT(difference.blended, difference.drawn / 4);
  const std::size_t left = in_front(result);
  EXPECT_LT(left * 10, slivers);
}

// Cells and parts of cells, and less than one.
TEST_P(ThreeCameras, InSmallRegions) {
  for (const Rect& small : {Rect{150, 120, 16, 24}, Rect{97, 80, 23, 31}, Rect{60, 60, 5, 3}}) {
    region = small;
    const Difference difference = beside_the_cpus();
    EXPECT_EQ(difference.drawn, difference.pixels);
    EXPECT_EQ(difference.other_source + difference.other_color, 0U);
    EXPECT_GT(difference.blended, 0U);
  }
}

// Whatever is bent by what: the RGB-D cameras' lenses may also be other than the user's.
TEST_P(ThreeCameras, ThroughEveryLens) {
  for (const LensModel users : testing::lens_models) {
    for (const LensModel others : testing::lens_models) {
      SCOPED_TRACE(std::string(name_of(users)) + " and " + name_of(others));
      scene = testing::AnalyticFrame({}, on_circle(3), others);
      scene.rig.color = testing::small_rig(0, users).color;
      for (const char* merge : {"choose", "blend"}) {
        options.merge_cameras = merge;
        const Difference difference = beside_the_cpus();
        expect_alike(difference);
        EXPECT_GT(difference.drawn, difference.pixels / 2);
      }
    }
  }
}

class NineCameras : public ManyCameras {
 protected:
  NineCameras() : ManyCameras(9) {}
};
INSTANTIATE_TEST_SUITE_P(Backends, NineCameras, ::testing::Values("gl", "gl_geometry"));

TEST_P(NineCameras, AreBlendedOnlyWhereOneSeesNothing) {
  for (const bool blended : {false, true}) {
    if (blended) scene.frame.rgbd[4].depth.own().fill(0);
    const Difference difference = beside_the_cpus();
    expect_alike(difference);
    EXPECT_GT(difference.drawn, difference.pixels / 2);
    EXPECT_EQ(difference.blended > difference.drawn / 4, blended);
    EXPECT_EQ(difference.blended > 0, blended);
  }
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
  const auto error_with = [&](const std::vector<std::string>& files) {
    return error_of([&] { context.run([&] { gl::compute_program(files); }); });
  };
  // vertices.comp calls what the files before it define.
  const std::string message = error_with({"frame.glsl", "vertices.comp"});
  EXPECT_THAT(message, ::testing::StartsWith("gl: shader vertices.comp:1"));
  EXPECT_THAT(message, ::testing::HasSubstr("find_vertex"));
  EXPECT_THAT(error_with({"none.comp"}), ::testing::HasSubstr("'none.comp'"));
}

TEST(GlContext, FailedCallsAreErrorsThatSayWhereAndOnWhat) {
  const gl::Context context;
  const auto check = [&](const char* doing) { context.run([&] { context.check(doing); }); };
  EXPECT_NO_THROW(check("nothing"));
  context.run([] { glBindBuffer(GL_TEXTURE_2D, 0); });
  const std::string message = error_of([&] { check("a test"); });
  EXPECT_THAT(message, ::testing::StartsWith("gl: a test: GL_INVALID_ENUM"));
  EXPECT_THAT(message, ::testing::HasSubstr(context.driver().name));
  EXPECT_NO_THROW(check("reported once"));
}

}  // namespace
}  // namespace diminish
