#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include "analytic_scene.h"
#include "detect/occlusion_masks.h"
#include "detect/silhouette/disc_dilation.h"
#include "detection.h"
#include "diminish/objects_of_detector.h"
#include "expect_error.h"
#include "mask_overlap.h"
#include "paths.h"
#include "truth_poses.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;
using ::testing::HasSubstr;

constexpr const char* thing = "{name: thing, detector: difference}";
const std::vector<Eigen::Vector3d> eyes = {{-0.55, 0.35, 1.1}, {0.6, 0.3, 1.0}};

/// A wall and a box that stands free in front of it.
AnalyticScene free_box() {
  AnalyticScene scene;
  scene.box_min.z() = 0.5;
  scene.box_max.z() = 0.6;
  return scene;
}

Detection seen_in(const AnalyticScene& scene) {
  AnalyticFrame now(scene, eyes);
  Detection detection(now.rig);
  detection.frame = now.frame;
  detection.poses = now.poses;
  return detection;
}

Mask box_mask(const AnalyticScene& scene, const Intrinsics& camera,
              const RigidTransform& camera_from_world) {
  Mask mask(camera.width, camera.height);
  scene.render(Lens(camera), camera_from_world, [&](int x, int y, const AnalyticScene::Hit& hit) {
    if (hit.on_box) mask(x, y) = 255;
  });
  return mask;
}

TEST(DifferenceOccluder, FindsWhatStandsFreeInAllCameras) {
  const AnalyticScene scene = free_box();
  Detection detection = seen_in(scene);
  const auto detector = make_detector(thing, detection.rig);
  EXPECT_FALSE(detector->needs_markers());
  const OccluderReport report = detection.detect(*detector);
  EXPECT_TRUE(report.in_color && report.in_rgbd[0] && report.in_rgbd[1]);
  EXPECT_EQ(report.message, "");
  EXPECT_GT(
      intersection_over_union(detection.masks.color, box_mask(scene, detection.rig.color,
                                                              *detection.poses.color_from_world)),
      0.93);
  DiscDilation dilation;
  for (std::size_t k = 0; k < 2; ++k) {
    SCOPED_TRACE(k);
    const RgbdCamera& camera = detection.rig.rgbd[k];
    const RigidTransform& depth_from_world = *detection.poses.depth_from_world[k];
    dilation.dilate(detection.masks.rgbd_depth[k], 1);
    EXPECT_GT(intersection_over_union(detection.masks.rgbd_depth[k],
                                      box_mask(scene, camera.depth, depth_from_world)),
              0.85);
    EXPECT_GT(intersection_over_union(
                  detection.masks.rgbd_color[k],
                  box_mask(scene, camera.color, camera.color_from_depth * depth_from_world)),
              0.85);
  }
}

TEST(DifferenceOccluder, FindsNothingWhereNothingStandsFree) {
  AnalyticScene scene;
  const auto expect_nothing = [&](const std::string& settings) {
    Detection detection = seen_in(scene);
    const auto detector = make_detector(settings, detection.rig);
    EXPECT_FALSE(detection.detect(*detector).in_color);
    EXPECT_FALSE(any_set(detection.masks.color));
    EXPECT_FALSE(any_set(detection.masks.rgbd_depth[0]));
  };
  scene.has_box = false;
  expect_nothing(thing);
  scene.has_box = true;  // a quarter of the way to the wall
  scene.box_min.z() = 0.2;
  scene.box_max.z() = 0.3;
  expect_nothing(thing);
  scene = free_box();
  expect_nothing("{name: thing, detector: difference, clearance: 0.6}");
}

TEST(DifferenceOccluder, FindsWhatOnlyTheColorCameraSees) {
  AnalyticScene scene;
  scene.has_box = false;
  Detection detection = seen_in(scene);
  const Rect object{110, 90, 70, 50};
  detection.frame.color.own().fill(object, {40, 200, 40});
  const auto detector = make_detector(thing, detection.rig);
  const OccluderReport report = detection.detect(*detector);
  EXPECT_TRUE(report.in_color);
  EXPECT_FALSE(report.in_rgbd[0]);
  Mask expected(detection.rig.color.width, detection.rig.color.height);
  expected.fill(object, 255);
  EXPECT_GT(intersection_over_union(detection.masks.color, expected), 0.9);
  EXPECT_FALSE(any_set(detection.masks.rgbd_depth[0]));
  EXPECT_FALSE(any_set(detection.masks.rgbd_color[0]));
}

/// An RGB-D camera that is late shows a moving object where it was.
TEST(DifferenceOccluder, LeavesThePictureAloneWhereAnObjectWas) {
  Detection detection = seen_in(free_box());
  AnalyticScene later = free_box();
  later.has_box = false;
  detection.frame.color =
      later.color_image(Lens(detection.rig.color), *detection.poses.color_from_world);
  const auto detector = make_detector(thing, detection.rig);
  EXPECT_FALSE(detection.detect(*detector).in_color);
}

/// What stands behind the object stays in the RGB-D cameras' images.
TEST(DifferenceOccluder, LeavesWhatIsBehindTheObject) {
  const AnalyticScene scene = free_box();
  Detection detection = seen_in(scene);
  AnalyticScene plate = scene;  // seen by the RGB-D cameras at the wall's foot
  plate.box_min = {-0.5, -0.12, 0.1};
  plate.box_max = {-0.3, 0.1, 0.15};
  for (std::size_t k = 0; k < 2; ++k) {
    const RgbdCamera& camera = detection.rig.rgbd[k];
    const Lens lens(camera.depth);
    const RigidTransform& depth_from_world = *detection.poses.depth_from_world[k];
    const Mask front = box_mask(scene, camera.depth, depth_from_world);
    const Mask behind = box_mask(plate, camera.depth, depth_from_world);
    const auto depth = plate.depth_image(lens, depth_from_world, camera.depth_unit_m);
    Mask hidden(camera.depth.width, camera.depth.height);
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 0; x < depth.width(); ++x) {
        if (behind(x, y) == 0 || front(x, y) != 0) continue;
        detection.frame.rgbd[k].depth.own()(x, y) = depth(x, y);
        hidden(x, y) = 255;
      }
    }
    const auto detector = make_detector(thing, detection.rig);
    EXPECT_TRUE(detection.detect(*detector).in_color);
    std::size_t lost = 0;
    for (std::size_t i = 0; i < hidden.size(); ++i) {
      lost += hidden.data()[i] != 0 && detection.masks.rgbd_depth[k].data()[i] != 0 ? 1 : 0;
    }
    EXPECT_LT(lost, count_nonzero(hidden, hidden.bounds()) / 20);
  }
}

/// Frames of a sequence, 50 ms apart.
class Sequence {
 public:
  Sequence() : detection_(seen_in(free_box())) { detector_ = make_detector(thing, detection_.rig); }
  /// Whether it is found in the next frame.
  bool finds(const AnalyticScene& scene) {
    const double stamp_s = detection_.frame.stamp_s + 0.05;
    detection_.frame = AnalyticFrame(scene, eyes).frame;
    detection_.frame.stamp_s = stamp_s;
    return detection_.detect(*detector_).in_color;
  }
  double overlap(const AnalyticScene& scene) const {
    return intersection_over_union(
        detection_.masks.color,
        box_mask(scene, detection_.rig.color, *detection_.poses.color_from_world));
  }
  void remember(bool wanted) { detection_.options.memory = wanted ? "on" : "off"; }

 private:
  Detection detection_;
  std::unique_ptr<OccluderDetector> detector_;
};

TEST(DifferenceOccluder, WhatComesAndGoesIsSeenAtOnce) {
  Sequence sequence;
  AnalyticScene without = free_box();
  without.has_box = false;
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(sequence.finds(without));
  AnalyticScene moving = free_box();
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(sequence.finds(moving));
    EXPECT_GT(sequence.overlap(moving), 0.9) << i;
    moving.box_min.x() += 0.05;
    moving.box_max.x() += 0.05;
  }
  EXPECT_FALSE(sequence.finds(without));
}

/// A box that stands hardly less than free, and in one frame a little more.
TEST(DifferenceOccluder, OneFrameDoesNotOutvoteThoseBefore) {
  const auto box_at = [](double back_m) {
    AnalyticScene scene = free_box();
    scene.box_min.z() = back_m;
    scene.box_max.z() = back_m + 0.1;
    return scene;
  };
  Sequence alone;
  alone.remember(false);
  // The least distance from the wall at which it is found, to a millimetre
  double back_m = 0.5;
  double too_near_m = 0.1;
  while (back_m - too_near_m > 0.001) {
    const double middle_m = (back_m + too_near_m) / 2;
    (alone.finds(box_at(middle_m)) ? back_m : too_near_m) = middle_m;
  }
  const AnalyticScene free = box_at(back_m);
  const AnalyticScene near_wall = box_at(too_near_m);
  ASSERT_TRUE(alone.finds(free));
  ASSERT_FALSE(alone.finds(near_wall));
  Sequence sequence;
  for (int i = 0; i < 8; ++i) EXPECT_FALSE(sequence.finds(near_wall));
  EXPECT_FALSE(sequence.finds(free));
  EXPECT_FALSE(sequence.finds(near_wall));
  // In the end what is seen counts.
  int late = 0;
  while (!sequence.finds(free) && late < 10) ++late;
  EXPECT_GT(late, 0);
  EXPECT_LT(late, 5);
}

/// An object whose marker nobody sees is removed by `difference` beside it.
TEST(DifferenceOccluder, CompletesWhatAMarkerFinds) {
  Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "calendar");
  Detection detection(recording.rig);
  ASSERT_TRUE(open_recording(recording, {})->next(detection.frame));
  const TruthPoses truth(recording.folder);
  detection.poses = truth.poses(0, recording.rig);
  detection.options.mask_margin_px = 0;
  const Mask expected =
      read_mask_image(recording.folder / "truth" / "mask" / (truth.frame(0) + ".png"));
  const auto overlap = [&] {
    OccluderStage stage(recording.rig, recording.scene);
    std::vector<OccluderReport> reports;
    stage.detect(detection.observation(), reports);
    return intersection_over_union(stage.masks().color, expected);
  };
  ASSERT_EQ(recording.scene.occluders[0].detector, "marker");
  EXPECT_EQ(overlap(), 0);
  recording.scene.occluders.push_back(objects_of_detector("difference", "test").at(0));
  EXPECT_GT(overlap(), 0.9);
}

TEST(DifferenceOccluder, WithoutCamerasItSaysSo) {
  Detection detection = seen_in(free_box());
  detection.frame.rgbd[0].missing = "late";
  detection.poses.color_from_depth[1].reset();
  const auto detector = make_detector(thing, detection.rig);
  EXPECT_EQ(detection.detect(*detector).message,
            "thing: no RGB-D camera sees what the colour camera sees");
  EXPECT_FALSE(any_set(detection.masks.color));
}

TEST(DifferenceOccluder, WrongSettingsAreNamed) {
  const Rig rig = testing::small_rig();
  EXPECT_THAT(
      error_of([&] { make_detector("name: a\ndetector: difference\nclearance: 1.5", rig); }),
      HasSubstr("s.yaml:3: clearance: expected a number from 0.05 to 0.95"));
  EXPECT_THAT(error_of([&] { make_detector("name: a\ndetector: difference\nfree: 1", rig); }),
              HasSubstr("free"));
  Rig none = rig;
  none.rgbd.clear();
  for (const Rig& without : {none, without_depth(rig)}) {
    EXPECT_THAT(error_of([&] { make_detector("name: a\ndetector: difference", without); }),
                HasSubstr("s.yaml:2: detector: difference needs a camera that measures depth "
                          "(rgbd) in rig.yaml"));
  }
}

TEST(DifferenceOccluder, SameMasksWhateverTheThreads) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "workbench");
  const auto masks_by = [&](int threads) {
    const oneapi::tbb::global_control most(oneapi::tbb::global_control::max_allowed_parallelism,
                                           static_cast<std::size_t>(threads));
    oneapi::tbb::task_arena arena(threads);
    Detection detection(recording.rig);
    EXPECT_TRUE(open_recording(recording, {})->next(detection.frame));
    detection.poses = TruthPoses(recording.folder).poses(0, recording.rig);
    const auto detector = make_detector(thing, recording.rig);
    arena.execute([&] { detection.detect(*detector); });
    return detection.masks;
  };
  const OcclusionMasks one = masks_by(1);
  EXPECT_TRUE(any_set(one.color));
  for (const int threads : {2, 7}) {
    const OcclusionMasks several = masks_by(threads);
    EXPECT_EQ(several.color, one.color);
    EXPECT_EQ(several.rgbd_color, one.rgbd_color);
    EXPECT_EQ(several.rgbd_depth, one.rgbd_depth);
  }
}

class DifferenceOccluderOnRecordings : public ::testing::TestWithParam<std::string> {};

TEST_P(DifferenceOccluderOnRecordings, AgreesWithTheTruth) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / GetParam());
  const auto source = open_recording(recording, {});
  const TruthPoses truth(recording.folder);
  const auto detector = make_detector(thing, recording.rig);
  Detection detection(recording.rig);
  DiscDilation dilation;
  ASSERT_GT(truth.size(), 0u);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    SCOPED_TRACE(truth.frame(i));
    ASSERT_TRUE(source->next(detection.frame));
    detection.poses = truth.poses(i, recording.rig);
    const OccluderReport report = detection.detect(*detector);
    EXPECT_TRUE(report.in_rgbd[0]);
    const Mask expected =
        read_mask_image(recording.folder / "truth" / "mask" / (truth.frame(i) + ".png"));
    EXPECT_GT(intersection_over_union(detection.masks.color, expected), 0.9);
    Mask grown = detection.masks.color;
    dilation.dilate(grown, Options{}.mask_margin_px);
    std::size_t found = 0;
    for (std::size_t k = 0; k < expected.size(); ++k) {
      found += expected.data()[k] != 0 && grown.data()[k] != 0 ? 1 : 0;
    }
    EXPECT_GT(static_cast<double>(found),
              0.97 * static_cast<double>(count_nonzero(expected, expected.bounds())));

    // The same scene without the object, as the colour camera would see it
    Image<Bgr> background =
        read_color_image(recording.folder / "truth" / "background" / (truth.frame(i) + ".jpg"));
    detection.frame.color = std::move(background);
    EXPECT_FALSE(detection.detect(*detector).in_color);
  }
}

INSTANTIATE_TEST_SUITE_P(, DifferenceOccluderOnRecordings,
                         ::testing::Values("calendar", "ball", "workbench"));

}  // namespace
}  // namespace diminish
