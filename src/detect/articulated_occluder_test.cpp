#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>

#include "detection.h"
#include "diminish/frame_source.h"
#include "diminish/occluder_settings.h"
#include "expect_error.h"
#include "mask_overlap.h"
#include "paths.h"
#include "temporary_folder.h"
#include "truth_poses.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

/// The bundled robot arm's first frame, with exact poses.
struct Arm {
  Arm()
      : recording(load_recording(std::filesystem::path(testing::recordings_dir()) / "arm")),
        spec(recording.scene.occluders.at(0)),
        detector(Registry<OccluderDetector>::get(spec.detector).make(spec, recording.rig)),
        detection(recording.rig) {
    const auto source = open_recording(recording, Options());
    source->next(detection.frame);
    detection.poses = TruthPoses(recording.folder).poses(0, recording.rig);
    truth = read_mask_image(recording.folder / "truth" / "mask" / "000000.png");
  }

  Recording recording;
  OccluderSpec spec;
  std::unique_ptr<OccluderDetector> detector;
  Detection detection;
  Mask truth;
};

TEST(ArticulatedOccluder, DrawsTheTruth) {
  Arm arm;
  const OccluderReport report = arm.detection.detect(*arm.detector);
  EXPECT_EQ(report.message, "");
  EXPECT_TRUE(report.in_color);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(report.in_rgbd[k]);
  EXPECT_GT(intersection_over_union(arm.detection.masks.color, arm.truth), 0.95);
}

TEST(ArticulatedOccluder, FollowsItsJoints) {
  Arm arm;
  // The list goes on to the next frame, a tenth of a second later.
  arm.detection.frame.stamp_s += 0.1;
  arm.detection.detect(*arm.detector);
  const double overlap = intersection_over_union(arm.detection.masks.color, arm.truth);
  EXPECT_LT(overlap, 0.93);
  EXPECT_GT(overlap, 0.5);
}

TEST(ArticulatedOccluder, SaysWhatItDoesNotKnow) {
  Arm arm;
  arm.detection.frame.stamp_s += 60;
  EXPECT_THAT(arm.detection.detect(*arm.detector).message,
              HasSubstr("arm: no joint positions within 0.1 s of"));
  arm.detection.poses.color_from_world.reset();
  EXPECT_EQ(arm.detection.detect(*arm.detector).message, "arm: where the world is, is not known");
}

TEST(ArticulatedOccluder, ACameraWithoutAPoseIsLeftOut) {
  Arm arm;
  arm.detection.poses.depth_from_world[1].reset();
  const OccluderReport report = arm.detection.detect(*arm.detector);
  EXPECT_TRUE(report.in_rgbd[0]);
  EXPECT_FALSE(report.in_rgbd[1]);
}

TEST(ArticulatedOccluder, NamesTheFilesOfACopy) {
  const Arm arm;
  // The chain, the list and six links
  EXPECT_EQ(arm.spec.settings->files().size(), 8U);
}

TEST(ArticulatedOccluder, WhatIsWrongWithItsFilesIsNamed) {
  const TemporaryFolder folder;
  const auto complaint = [&](const std::string& chain, const std::string& angles) {
    std::ofstream(folder.path() / "arm.yaml") << chain;
    std::ofstream(folder.path() / "angles.txt") << angles;
    return error_of([&] {
      make_detector("{name: arm, detector: articulated, chain: arm.yaml, angles: angles.txt}",
                    Arm().recording.rig, folder.path() / "scene.yaml");
    });
  };
  const std::string link = "links: [{name: base, mesh: base.obj}]\n";
  EXPECT_THAT(complaint("links: []\n", "1\n"), HasSubstr("arm.yaml:1: links"));
  EXPECT_THAT(complaint(link, "1 2\n"), HasSubstr("angles.txt:1: expected a timestamp and the"));
  EXPECT_THAT(complaint(link, "1\n"), HasSubstr("base.obj"));
}

}  // namespace
}  // namespace diminish
