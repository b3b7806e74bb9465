#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "diminish/depth_estimator.h"
#include "diminish/frame_source.h"
#include "estimate/depth_estimation.h"
#include "expect_error.h"
#include "paths.h"
#include "truth_poses.h"

namespace diminish {
namespace {

/// The bundled pair of colour cameras: its first frame, with exact poses.
struct StereoFrame {
  StereoFrame()
      : recording(load_recording(std::filesystem::path(testing::recordings_dir()) / "stereo")) {
    open_recording(recording, options)->next(frame);
    poses = TruthPoses(recording.folder).poses(0, recording.rig);
    masks.color.resize(recording.rig.color.width, recording.rig.color.height, 0);
    for (const RgbdCamera& camera : recording.rig.rgbd) {
      masks.rgbd_color.emplace_back(camera.color.width, camera.color.height, std::uint8_t{0});
      masks.rgbd_depth.emplace_back(camera.depth.width, camera.depth.height, std::uint8_t{0});
    }
  }

  /// What the estimate makes of the frame.
  const FrameSet& estimate(const Rect& drawn) {
    estimation.choose("stereo");
    const FrameSet& completed = estimation.begin(frame);
    estimation.estimate({}, poses, masks, drawn, options);
    return completed;
  }

  Recording recording;
  Options options;
  FrameSet frame;
  Poses poses;
  OcclusionMasks masks;
  DepthEstimation estimation{recording.rig, recording.scene};
};

struct Agreement {
  int known = 0;  ///< true depth inside the range
  int found = 0;
  int right = 0;  ///< within two pixels of disparity
};

Agreement compare_with_truth(const StereoFrame& stereo, ImageView<std::uint16_t> depth) {
  const cv::Mat truth = cv::imread(
      (stereo.recording.folder / "truth/depth/left/000000.png").string(), cv::IMREAD_UNCHANGED);
  const RgbdCamera& camera = stereo.recording.rig.rgbd[0];
  Agreement agreement;
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      const double z = truth.at<std::uint16_t>(y, x) * camera.depth_unit_m;
      if (!(z > camera.nearest_m && z < camera.farthest_m)) continue;
      ++agreement.known;
      if (depth(x, y) == 0) continue;
      ++agreement.found;
      const double error_px =
          camera.depth.fx * 0.25 * std::abs(1 / (depth(x, y) * camera.depth_unit_m) - 1 / z);
      agreement.right += error_px < 2 ? 1 : 0;
    }
  }
  return agreement;
}

TEST(StereoEstimator, FindsMostOfTheTrueDepth) {
  StereoFrame stereo;
  const FrameSet& completed = stereo.estimate(stereo.recording.rig.color.bounds());
  const Agreement agreement = compare_with_truth(stereo, completed.rgbd[0].depth);
  // The left quarter of its picture is not in the other's.
  EXPECT_GT(agreement.found, agreement.known * 70 / 100);
  EXPECT_GT(agreement.right, agreement.found * 88 / 100);
}

TEST(StereoEstimator, LooksOnlyWhereSomethingWillBeDrawn) {
  StereoFrame stereo;
  const FrameSet& completed = stereo.estimate({1180, 60, 60, 60});
  int found = 0;
  const ImageView<std::uint16_t> depth = completed.rgbd[0].depth;
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) found += depth(x, y) != 0 ? 1 : 0;
  }
  EXPECT_GT(found, 100);
  EXPECT_LT(found, depth.width() * depth.height() / 4);
}

TEST(StereoEstimator, IsTheSameForAnyNumberOfThreads) {
  const oneapi::tbb::global_control enough(oneapi::tbb::global_control::max_allowed_parallelism, 4);
  StereoFrame one;
  StereoFrame four;
  const Rect all = one.recording.rig.color.bounds();
  const FrameSet* by_one = nullptr;
  const FrameSet* by_four = nullptr;
  oneapi::tbb::task_arena(1).execute([&] { by_one = &one.estimate(all); });
  oneapi::tbb::task_arena(4).execute([&] { by_four = &four.estimate(all); });
  for (std::size_t k = 0; k < 2; ++k) {
    Image<std::uint16_t> first;
    Image<std::uint16_t> second;
    copy(by_one->rgbd[k].depth.view(), first);
    copy(by_four->rgbd[k].depth.view(), second);
    EXPECT_EQ(first, second);
  }
}

TEST(StereoEstimator, ACameraThatSeesNothingNewIsSaid) {
  StereoFrame stereo;
  stereo.poses.color_from_depth[1] = stereo.poses.color_from_depth[0];
  stereo.estimate(stereo.recording.rig.color.bounds());
  ASSERT_EQ(stereo.estimation.messages().size(), 2U);
  EXPECT_EQ(stereo.estimation.messages()[0],
            "left: no other camera sees the scene from elsewhere, so its depth is not known");
}

/// The same place, but the second camera looks past what the first sees, or away from it.
TEST(StereoEstimator, CamerasThatDoNotOverlapAreSaid) {
  for (const double degrees : {75., 180.}) {
    SCOPED_TRACE(degrees);
    StereoFrame stereo;
    RigidTransform turn;
    turn.rotation =
        Eigen::AngleAxisd(degrees / 180 * M_PI, Eigen::Vector3d::UnitY()).toRotationMatrix();
    stereo.poses.color_from_depth[1] = *stereo.poses.color_from_depth[1] * turn;
    const FrameSet& completed = stereo.estimate(stereo.recording.rig.color.bounds());
    EXPECT_EQ(compare_with_truth(stereo, completed.rgbd[0].depth).found, 0);
    ASSERT_EQ(stereo.estimation.messages().size(), 2U);
    EXPECT_EQ(stereo.estimation.messages()[0],
              "left: no other camera looks the same way at what it sees between 0.4 and 3 m "
              "(range_m), so its depth is not known");
  }
}

TEST(StereoEstimator, ACameraWithoutPicturesIsLeftOut) {
  StereoFrame stereo;
  stereo.frame.rgbd[1].missing = "right: no color image within 0.02 s";
  stereo.frame.rgbd[1].color.own().resize(0, 0);
  const FrameSet& completed = stereo.estimate(stereo.recording.rig.color.bounds());
  EXPECT_EQ(compare_with_truth(stereo, completed.rgbd[0].depth).found, 0);
  EXPECT_EQ(stereo.estimation.messages().size(), 1U);
}

TEST(StereoEstimator, NeedsTwoCameras) {
  Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "calendar");
  recording.rig = without_depth(recording.rig);
  DepthEstimation estimation(recording.rig, recording.scene);
  EXPECT_EQ(error_of([&] { estimation.choose("stereo"); }),
            "estimate_depth stereo: expected two cameras or more beside the user's, the rig has 1");
}

}  // namespace
}  // namespace diminish
