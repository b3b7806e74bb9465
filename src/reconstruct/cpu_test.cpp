#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "first_frame.h"
#include "mixed_color.h"
#include "picture_difference.h"

namespace diminish {
namespace {

/// The fast version draws the same pixels of the same cameras in the same colours, within one level
/// of rounding.
void expect_same(const Reconstruction& fast, const Reconstruction& plain) {
  ASSERT_EQ(fast.region, plain.region);
  std::size_t drawn = 0;
  std::size_t other_source = 0;
  std::size_t other_color = 0;
  int worst = 0;
  double worst_depth = 0;
  for (int y = 0; y < plain.color.height(); ++y) {
    for (int x = 0; x < plain.color.width(); ++x) {
      const Bgra& a = fast.color(x, y);
      const Bgra& b = plain.color(x, y);
      ASSERT_EQ(a.a, b.a) << x << ' ' << y;
      if (a.a == 0) {
        ASSERT_EQ(fast.source(x, y), 0);
        ASSERT_EQ(fast.depth_m(x, y), 0);
        continue;
      }
      ASSERT_TRUE(plain.region.keeps(x, y)) << x << ' ' << y;
      ++drawn;
      if (fast.source(x, y) != plain.source(x, y)) {
        ++other_source;
        continue;
      }
      worst = std::max(worst, testing::difference(a, b));
      other_color += testing::difference(a, b) > 1 ? 1 : 0;
      worst_depth =
          std::max(worst_depth, std::abs(double{fast.depth_m(x, y)} / plain.depth_m(x, y) - 1));
    }
  }
  EXPECT_GT(drawn, 1000U);
  // On a texture's sharpest edges a place that is rounded otherwise shows.
  EXPECT_LE(worst, 3);
  EXPECT_LE(other_color * 100000, drawn);
  EXPECT_LT(worst_depth, 2e-4) << "relative";
  // Where two surfaces are as far apart as counts as one, rounding decides.
  EXPECT_LE(other_source * 100000, drawn);
}

/// Where several cameras are blended, rounding decides now and then which cells a camera covers.
void expect_nearly_same_blend(const Reconstruction& fast, const Reconstruction& plain) {
  const Rect& region = plain.region;
  std::size_t drawn = 0;
  std::size_t blended = 0;
  std::size_t others = 0;
  for (int y = region.y; y < region.bottom(); ++y) {
    for (int x = region.x; x < region.right(); ++x) {
      drawn += plain.color(x, y).a != 0 ? 1U : 0U;
      blended += plain.second.share(x, y) != 0 ? 1U : 0U;
      const Bgra a = testing::mixed_color(fast, x, y);
      const Bgra b = testing::mixed_color(plain, x, y);
      others += a.a != b.a || testing::difference(a, b) > 2 ? 1U : 0U;
    }
  }
  EXPECT_GT(blended, drawn / 10);
  EXPECT_LE(others * 1000, drawn);
}

class VectorizedOnRecordings : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Recordings, VectorizedOnRecordings,
                         ::testing::Values("calendar", "ball", "workbench"));

void compare_on(const char* recording, const char* merge_cameras) {
  testing::FirstFrame first(recording);
  first.options.merge_cameras = merge_cameras;
  const auto fast = Registry<Reconstructor>::get("cpu")(first.rig());
  const auto plain = Registry<Reconstructor>::get("reference")(first.rig());
  Reconstruction a;
  Reconstruction b;
  for (const bool masked : {false, true}) {
    if (masked) first.mask_parts();
    for (const TiledRegion& region : {first.whole_view(), TiledRegion(Rect{300, 200, 421, 333}),
                                      first.tiled_part(), TiledRegion(Rect{0, 900, 1, 124})}) {
      const bool empty = region.width == 1;
      first.reconstruct(*fast, region, a);
      first.reconstruct(*plain, region, b);
      if (empty) {
        EXPECT_EQ(a.color, b.color);
      } else if (first.options.merge_cameras == "choose") {
        expect_same(a, b);
      } else {
        expect_nearly_same_blend(a, b);
      }
    }
  }
}

TEST_P(VectorizedOnRecordings, DrawsWhatThePlainVersionDraws) {
  compare_on(GetParam(), "choose");
}

TEST(VectorizedReconstructor, BlendsAsThePlainVersionDoes) {
  compare_on("workbench", "blend");
}

TEST(VectorizedReconstructor, DrawsThroughEveryLensWhatThePlainVersionDraws) {
  for (const LensModel model : testing::lens_models) {
    SCOPED_TRACE(name_of(model));
    const testing::AnalyticFrame frame({}, {{-0.45, 0.3, 0.9}, {0.5, 0.3, 0.9}}, model);
    const OcclusionMasks masks = testing::empty_masks(frame.rig);
    Options options;
    options.merge_cameras = "choose";
    Reconstruction a;
    Reconstruction b;
    for (const auto& [backend, result] : {std::pair{"cpu", &a}, std::pair{"reference", &b}}) {
      Registry<Reconstructor>::get(backend)(frame.rig)->reconstruct(
          frame.frame, testing::depths_of(frame.frame), frame.poses, masks,
          frame.rig.color.bounds(), options, *result);
    }
    expect_same(a, b);
  }
}

// A camera so near that each cell covers hundreds of pixels.
TEST(VectorizedReconstructor, DrawsLargeCells) {
  const testing::AnalyticScene scene;
  testing::AnalyticFrame frame(scene, {Eigen::Vector3d(-0.45, 0.3, 0.9)});
  frame.rig.color.fx *= 12;
  frame.rig.color.fy *= 12;
  const OcclusionMasks masks = testing::empty_masks(frame.rig);
  Reconstruction a;
  Reconstruction b;
  const Rect region = frame.rig.color.bounds();
  Registry<Reconstructor>::get("cpu")(frame.rig)->reconstruct(
      frame.frame, testing::depths_of(frame.frame), frame.poses, masks, region, {}, a);
  Registry<Reconstructor>::get("reference")(frame.rig)->reconstruct(
      frame.frame, testing::depths_of(frame.frame), frame.poses, masks, region, {}, b);
  expect_same(a, b);
}

}  // namespace
}  // namespace diminish
