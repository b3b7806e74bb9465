#include "memory/memory_stage.h"

#include <gtest/gtest.h>

#include "analytic_scene.h"
#include "scene/scene_sampler.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

constexpr Rect hidden{100, 80, 120, 90};  ///< in the picture, around the box

/// One moment after the other, with what an RGB-D camera beside the user's sees of a wall and a
/// box.
class Memory : public ::testing::Test {
 protected:
  struct Moment {
    double stamp_s = 0;
    bool has_box = true;
    Rect object = {};          ///< to remove, in the picture
    Rect hole = {};            ///< in the object
    bool is_witnessed = true;  ///< the RGB-D camera delivers
    double turn = 0;           ///< an error of the user's camera's pose, about its axis; radians
    bool is_lost = false;      ///< the object is not found
  };

  /// What the user sees, and where it comes from.
  const Reconstruction& show(const Moment& moment) {
    AnalyticScene scene;
    scene.has_box = moment.has_box;
    AnalyticFrame now(scene, {{-0.25, 0.05, 1.1}});
    truth = now.frame.color.own();
    now.frame.stamp_s = moment.stamp_s;
    if (!moment.is_witnessed) {
      now.frame.rgbd[0].missing = "rgbd0: lost";
      now.poses.depth_from_world[0].reset();
      now.poses.color_from_depth[0].reset();
    }
    RigidTransform error;
    error.rotation = Eigen::AngleAxisd(moment.turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    now.poses.color_from_world = error * *now.poses.color_from_world;
    OcclusionMasks masks = testing::empty_masks(now.rig);
    masks.color.fill(moment.object, 255);
    masks.color.fill(moment.hole, 0);
    for (int y = moment.object.y; y < moment.object.bottom(); ++y) {
      for (int x = moment.object.x; x < moment.object.right(); ++x) {
        if (masks.color(x, y) != 0) now.frame.color.own()(x, y) = {255, 0, 255};
      }
    }
    TiledRegion region(intersect(grow(moment.object, 16), now.rig.color.bounds()));
    drawer->reconstruct(now.frame, testing::depths_of(now.frame), now.poses, masks, region, options,
                        result);
    sampler.sample(now.frame, now.poses, masks, samples);
    OccluderReport report;
    if (moment.is_lost) report.message = "board: not found";
    const MemoryStage::Turn turn(memory);
    memory.remember({now.frame, now.poses, masks, moment.object, region, maps, options}, samples,
                    {report}, result, memory_report = {});
    return result;
  }

  static std::size_t count(const Reconstruction& drawn, std::uint8_t source) {
    return count_equal(drawn.source, source, hidden);
  }
  /// The mean difference from the truth, of what comes from `source`; levels.
  double error(const Reconstruction& drawn, std::uint8_t source) const {
    double sum = 0;
    int count = 0;
    for (int y = hidden.y; y < hidden.bottom(); ++y) {
      for (int x = hidden.x; x < hidden.right(); ++x) {
        if (drawn.source(x, y) != source) continue;
        const Bgra shown = drawn.color(x, y);
        const Bgr real = truth(x, y);
        sum +=
            (std::abs(shown.b - real.b) + std::abs(shown.g - real.g) + std::abs(shown.r - real.r)) /
            3.;
        ++count;
      }
    }
    return count > 0 ? sum / count : 0;
  }
  /// The pixels that show the box, whose red is like nothing else.
  static int count_box(const Reconstruction& drawn) {
    int found = 0;
    for (int y = hidden.y; y < hidden.bottom(); ++y) {
      for (int x = hidden.x; x < hidden.right(); ++x) {
        const Bgra shown = drawn.color(x, y);
        found += drawn.source(x, y) != 0 && shown.r > 200 && shown.b < 60 ? 1 : 0;
      }
    }
    return found;
  }

  const Rig rig = testing::small_rig();
  Options options = [] {
    Options on;
    on.memory = "on";
    return on;
  }();
  std::unique_ptr<Reconstructor> drawer = Registry<Reconstructor>::get("cpu")(rig);
  SceneSampler sampler{rig};
  SceneSamples samples;
  MemoryStage memory{rig};
  std::vector<ColorMap> maps = std::vector<ColorMap>(256);
  Reconstruction result;
  MemoryReport memory_report;
  Image<Bgr> truth;
  static constexpr std::size_t pixels = hidden.width * hidden.height;
};

TEST_F(Memory, ShowsTheUsersOwnPixelsWhereTheyAreWitnessed) {
  show({.stamp_s = 0});
  const Reconstruction& shown = show({.stamp_s = 0.3, .object = hidden});
  EXPECT_GT(count(shown, provenance::witnessed), pixels * 7 / 10);
  EXPECT_LT(error(shown, provenance::witnessed), 3);
}

TEST_F(Memory, RemembersWhereNobodyLooks) {
  show({.stamp_s = 0});
  const Reconstruction& shown = show({.stamp_s = 0.3, .object = hidden, .is_witnessed = false});
  EXPECT_GT(count(shown, provenance::remembered), pixels * 9 / 10);
  EXPECT_LT(error(shown, provenance::remembered), 5);
}

TEST_F(Memory, ShowsOnlyWhatIsWitnessedIfToldSo) {
  options.memory = "witnessed";
  show({.stamp_s = 0});
  EXPECT_GT(count(show({.stamp_s = 0.3, .object = hidden}), provenance::witnessed), pixels / 2);
  EXPECT_EQ(count(result, provenance::remembered), 0U);
  show({.stamp_s = 0.6, .object = hidden, .is_witnessed = false});
  EXPECT_EQ(count(result, 0), pixels);
}

TEST_F(Memory, ForgetsWhatIsGoneAtOnceAndForEver) {
  show({.stamp_s = 0});
  EXPECT_LT(count_box(show({.stamp_s = 0.3, .has_box = false, .object = hidden})), 100);
  EXPECT_LT(
      count_box(show({.stamp_s = 0.6, .has_box = false, .object = hidden, .is_witnessed = false})),
      100);
}

TEST_F(Memory, ShowsWhatHasComeAsItIsNow) {
  show({.stamp_s = 0, .has_box = false});
  const Reconstruction& shown = show({.stamp_s = 0.3, .object = hidden});
  EXPECT_GT(count_box(shown), 2500);
  EXPECT_LT(error(shown, provenance::first_rgbd), 12);
}

TEST_F(Memory, LearnsNothingUnderTheObjects) {
  show({.stamp_s = 0, .object = hidden});
  const Reconstruction& shown = show({.stamp_s = 0.3, .object = hidden, .is_witnessed = false});
  EXPECT_EQ(count(shown, provenance::remembered), 0U);
}

TEST_F(Memory, ShowsNoSpecks) {
  const auto remembered_through = [&](const Rect& hole) {
    memory.forget();
    show({.stamp_s = 0, .object = hidden, .hole = hole});
    return count(show({.stamp_s = 0.3, .object = hidden, .is_witnessed = false}),
                 provenance::remembered);
  };
  EXPECT_GT(remembered_through({120, 95, 60, 50}), 800U);
  EXPECT_EQ(remembered_through({150, 110, 24, 24}), 0U);
}

TEST_F(Memory, LearnsNothingThatOnlyPasses) {
  show({.stamp_s = 0, .has_box = false});
  show({.stamp_s = 0.5});
  show({.stamp_s = 1});
  const Reconstruction& shown =
      show({.stamp_s = 1.5, .has_box = false, .object = hidden, .is_witnessed = false});
  EXPECT_LT(count_box(shown), 100);
  EXPECT_GT(count(shown, provenance::remembered), pixels * 9 / 10);
}

TEST_F(Memory, LearnsWhatHasStayed) {
  show({.stamp_s = 0, .has_box = false});
  for (const double stamp_s : {2., 4., 6.}) show({.stamp_s = stamp_s});
  const Reconstruction& shown = show({.stamp_s = 6.3, .object = hidden});
  EXPECT_GT(count_box(shown), 2500);
  EXPECT_GT(count(shown, provenance::witnessed), pixels * 6 / 10);
  EXPECT_LT(error(shown, provenance::witnessed), 3);
}

TEST_F(Memory, LearnsNothingWhileAnObjectIsLost) {
  show({.stamp_s = 0, .object = hidden});
  show({.stamp_s = 0.5, .is_lost = true});
  const Reconstruction& shown = show({.stamp_s = 1, .object = hidden, .is_witnessed = false});
  EXPECT_EQ(count(shown, provenance::remembered), 0U);
}

TEST_F(Memory, ForgetsWithAge) {
  options.memory_max_age_s = 5;
  show({.stamp_s = 0});
  show({.stamp_s = 4, .object = hidden, .is_witnessed = false});
  EXPECT_GT(count(result, provenance::remembered), 0U);
  show({.stamp_s = 6, .object = hidden, .is_witnessed = false});
  EXPECT_EQ(count(result, provenance::remembered), 0U);
}

TEST_F(Memory, SaysHowOldWhatIsRememberedIs) {
  show({.stamp_s = 1});
  EXPECT_EQ(memory_report.keyframes, 1U);
  EXPECT_GT(memory_report.bytes, rig.color.width * rig.color.height * sizeof(Bgr));
  EXPECT_EQ(memory_report.oldest_age_s, 0);
  // What is under the object is not learnt again.
  show({.stamp_s = 3.5, .object = hidden});
  show({.stamp_s = 4, .object = hidden, .is_witnessed = false});
  EXPECT_EQ(memory_report.keyframes, 2U);
  EXPECT_DOUBLE_EQ(memory_report.median_age_s, 3);
  EXPECT_DOUBLE_EQ(memory_report.oldest_age_s, 3);
}

TEST_F(Memory, ForgetsWhenToldAndWhenARecordingBeginsAnew) {
  for (const bool is_told : {false, true}) {
    show({.stamp_s = 10});
    if (is_told) memory.forget();
    show({.stamp_s = is_told ? 11. : 0., .object = hidden, .is_witnessed = false});
    EXPECT_EQ(count(result, provenance::remembered), 0U);
  }
}

// The user's camera was moved, and its pose does not say so.
TEST_F(Memory, ShowsNothingInAWrongPlace) {
  show({.stamp_s = 0});
  show({.stamp_s = 0.3, .object = hidden, .turn = 0.3});
  EXPECT_EQ(count(result, provenance::witnessed) + count(result, provenance::remembered), 0U);
}

}  // namespace
}  // namespace diminish
