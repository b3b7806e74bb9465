#include "composite/steady_inventions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "analytic_scene.h"

namespace diminish {
namespace {

constexpr Rect hidden{100, 80, 90, 70};
constexpr Rect seen_part{130, 100, 20, 20};  ///< of it
constexpr Rect bar{112, 80, 10, 70};         ///< of it
constexpr Rect depthless{160, 110, 16, 16};  ///< of it
constexpr int error = 40;                    ///< of the second invention, levels
constexpr double frame_s = 0.035;            ///< the half-life

/// A wall of which a part is invented; the user moves sidewards.
class Inventions : public ::testing::Test {
 protected:
  struct Moment {
    double stamp_s = 0;
    double user_m = 0;
    int error = 0;  ///< brighter than the wall by so much
    bool has_pose = true;
  };

  const Image<Bgr>& show(const Moment& moment) {
    const testing::AnalyticFrame now({.has_box = false}, {}, LensModel::plumb_bob,
                                     Eigen::Vector3d(0.05 + moment.user_m, 0.02, 1.2));
    const RigidTransform& color_from_world = *now.poses.color_from_world;
    const Eigen::Vector3d normal = color_from_world.rotation.col(2);
    const std::vector<BackgroundPlane> wall{
        {normal.cast<float>(), static_cast<float>(normal.dot(color_from_world.translation))}};
    copy(now.frame.color.view(), truth);
    copy(now.frame.color.view(), result.picture);
    for (Bgr& color : result.picture) {
      for (std::uint8_t* channel : {&color.b, &color.g, &color.r}) {
        *channel = static_cast<std::uint8_t>(std::min(255, *channel + moment.error));
      }
    }
    before = result.picture;
    const Rect whole = result.picture.bounds();
    result.provenance.resize(whole.width, whole.height, provenance::camera);
    result.provenance.fill(hidden, provenance::inpainted);
    result.provenance.fill(bar, provenance::estimated);
    result.report.estimated_pixels = std::size_t{bar.width} * bar.height;
    result.provenance.fill(seen_part, 1);
    result.surfaces.region = whole;
    result.surfaces.label.resize(whole.width, whole.height, surface_label::first_plane);
    result.surfaces.label.fill(depthless, surface_label::unknown);
    std::optional<RigidTransform> pose;
    if (moment.has_pose) pose = color_from_world;
    steady.steady({moment.stamp_s, pose, hidden, &wall}, result);
    return result.picture;
  }
  bool is_changed(int x, int y) const { return !(result.picture(x, y) == before(x, y)); }
  int count_changed() const {
    int count = 0;
    for (int y = 0; y < before.height(); ++y) {
      for (int x = 0; x < before.width(); ++x) count += is_changed(x, y) ? 1 : 0;
    }
    return count;
  }

  SteadyInventions steady{testing::small_rig().color};
  DiminishedFrame result;
  Image<Bgr> truth, before;
};

TEST_F(Inventions, AreMixedWithWhatTheLastFrameShowedOfThePlace) {
  show({});
  const Image<Bgr>& picture = show({frame_s, 0.02, error});
  int mixed = 0;
  for (int y = hidden.y; y < hidden.bottom(); ++y) {
    for (int x = hidden.x; x < hidden.right(); ++x) {
      if (!is_changed(x, y)) continue;
      ++mixed;
      // Half of the error is left, wherever the user has moved.
      EXPECT_NEAR(picture(x, y).g, std::min(255, truth(x, y).g + error / 2), 3) << x << ", " << y;
    }
  }
  EXPECT_GT(mixed, hidden.width * hidden.height * 7 / 10);
  EXPECT_TRUE(is_changed(bar.x + bar.width / 2, bar.y + bar.height / 2));
}

TEST_F(Inventions, OnlyAreChanged) {
  show({});
  show({frame_s, 0, error});
  for (int y = 0; y < before.height(); ++y) {
    for (int x = 0; x < before.width(); ++x) {
      const bool may_change =
          hidden.contains(x, y) && !seen_part.contains(x, y) && !depthless.contains(x, y);
      EXPECT_TRUE(may_change || !is_changed(x, y)) << x << ", " << y;
    }
  }
}

TEST_F(Inventions, StandAloneWithoutAFrameBefore) {
  show({0, 0, error});
  EXPECT_EQ(count_changed(), 0);
  show({1, 0, 0});
  EXPECT_EQ(count_changed(), 0) << "long ago";
  show({0.5, 0, error});
  EXPECT_EQ(count_changed(), 0) << "back in time";
  show({0.5 + frame_s, 0, 0, false});
  EXPECT_EQ(count_changed(), 0) << "without a pose";
  show({0.5 + 2 * frame_s, 0, error});
  EXPECT_EQ(count_changed(), 0) << "after a frame without a pose";
  steady.forget();
  show({0.5 + 3 * frame_s, 0, 0});
  EXPECT_EQ(count_changed(), 0) << "forgotten";
  show({0.5 + 4 * frame_s, 0, error});
  EXPECT_GT(count_changed(), 0);
}

}  // namespace
}  // namespace diminish
