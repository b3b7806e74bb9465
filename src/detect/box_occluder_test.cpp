#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "detect/silhouette/silhouette.h"
#include "detection.h"
#include "expect_error.h"
#include "mask_overlap.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

/// A rig that looks along z at a wall at 2 m with a square plate of 0.4 m in front of it, at 1 m.
class BoxOccluderOnPlate : public ::testing::Test {
 protected:
  BoxOccluderOnPlate() {
    const RigidTransform rgbd1_from_world{
        Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).toRotationMatrix(), {-0.4, 0, 0}};
    poses.color_from_world = {Eigen::Matrix3d::Identity(), {0.1, 0.05, 0}};
    poses.depth_from_world = {RigidTransform{}, rgbd1_from_world};
    for (const auto& depth_from_world : poses.depth_from_world) {
      poses.color_from_depth.push_back(*poses.color_from_world * depth_from_world->inverse());
    }
  }

  static Rig make_rig() {
    Rig rig;
    rig.color = {320, 256, 280, 280, 160, 128, {-0.1, 0.05, 0, 0, 0}};
    RgbdCamera camera;
    camera.name = "rgbd0";
    camera.color = {400, 300, 300, 300, 200, 150, {0.04, 0, 0, 0, 0}};
    camera.depth = {200, 160, 150, 150, 100, 80, {0.05, 0, 0, 0, 0}};
    camera.color_from_depth.translation = {0.05, 0, 0};
    rig.rgbd = {camera, camera};
    rig.rgbd[1].name = "rgbd1";
    return rig;
  }

  std::vector<Eigen::Vector3d> plate(const RigidTransform& camera_from_world) const {
    std::vector<Eigen::Vector3d> corners;
    for (const double x : {-0.2, 0.2}) {
      for (const double y : {-0.2, 0.2}) {
        corners.push_back(camera_from_world * Eigen::Vector3d(x, y, 1));
      }
    }
    return corners;
  }

  Mask plate_mask(const Intrinsics& intrinsics, const RigidTransform& camera_from_world) const {
    Mask mask(intrinsics.width, intrinsics.height);
    SilhouetteDrawer(Lens(intrinsics)).fill_convex_hull(plate(camera_from_world), mask);
    return mask;
  }

  /// The depth of wall and plate as RGB-D camera k sees them.
  void draw_depth(std::size_t k, Detection& detection) const {
    const Intrinsics& intrinsics = rig.rgbd[k].depth;
    const Lens lens(intrinsics);
    const RigidTransform& depth_from_world = *poses.depth_from_world[k];
    const Mask on_plate = plate_mask(intrinsics, depth_from_world);
    const Eigen::Vector3d normal = depth_from_world.rotation.col(2);
    for (int y = 0; y < intrinsics.height; ++y) {
      for (int x = 0; x < intrinsics.width; ++x) {
        const double distance = on_plate(x, y) ? 1 : 2;
        const Eigen::Vector3d ray = lens.undistort({x, y}).homogeneous();
        const double z = (distance + normal.dot(depth_from_world.translation)) / normal.dot(ray);
        detection.frame.rgbd[k].depth.own()(x, y) =
            static_cast<std::uint16_t>(std::lround(1000 * z));
      }
    }
  }

  Detection make_detection() const {
    Detection detection(rig);
    detection.poses = poses;
    draw_depth(0, detection);
    draw_depth(1, detection);
    return detection;
  }

  static std::string box_in(const std::string& frame) {
    return "{name: zone, detector: box, frame: " + frame +
           ", min: [-0.5, -0.5, 0.8], max: [0.5, 0.5, 1.2]}";
  }

  Rig rig = make_rig();
  Poses poses;
};

TEST_F(BoxOccluderOnPlate, WhatIsInTheBoxIsMaskedInAllCameras) {
  for (const char* frame : {"world", "rgbd0"}) {  // rgbd0's depth frame is the world here
    SCOPED_TRACE(frame);
    const auto detector = make_detector(box_in(frame), rig);
    EXPECT_FALSE(detector->needs_markers());
    Detection detection = make_detection();
    const OccluderReport report = detection.detect(*detector);
    EXPECT_TRUE(report.in_color && report.in_rgbd[0] && report.in_rgbd[1]);
    EXPECT_EQ(report.message, "");
    const Mask expected = plate_mask(rig.color, *poses.color_from_world);
    EXPECT_GT(intersection_over_union(detection.masks.color, expected), 0.95);
    for (std::size_t k = 0; k < 2; ++k) {
      const RigidTransform& depth_from_world = *poses.depth_from_world[k];
      EXPECT_EQ(detection.masks.rgbd_depth[k], plate_mask(rig.rgbd[k].depth, depth_from_world));
      const Mask in_color =
          plate_mask(rig.rgbd[k].color, rig.rgbd[k].color_from_depth * depth_from_world);
      EXPECT_GT(intersection_over_union(detection.masks.rgbd_color[k], in_color), 0.95);
    }
  }
}

TEST_F(BoxOccluderOnPlate, PixelsWithoutDepthOnTheObjectAreClosed) {
  const auto detector = make_detector(box_in("world"), rig);
  Detection detection = make_detection();
  detection.frame.rgbd[1].missing = "late";
  for (int y = 78; y < 82; ++y) {
    for (int x = 98; x < 102; ++x) detection.frame.rgbd[0].depth.own()(x, y) = 0;
  }
  EXPECT_TRUE(detection.detect(*detector).in_color);
  const Mask expected = plate_mask(rig.color, *poses.color_from_world);
  EXPECT_GT(intersection_over_union(detection.masks.color, expected), 0.95);
  EXPECT_EQ(detection.masks.color(188, 142), 255);  // the hole's middle
  EXPECT_FALSE(any_set(detection.masks.rgbd_color[1]));
}

TEST_F(BoxOccluderOnPlate, OneCameraMasksTheObjectForAnother) {
  const auto detector = make_detector(box_in("world"), rig);
  Detection detection = make_detection();
  detection.frame.rgbd[1].depth.own().fill(0);
  EXPECT_TRUE(detection.detect(*detector).in_rgbd[1]);
  const Mask expected =
      plate_mask(rig.rgbd[1].color, rig.rgbd[1].color_from_depth * *poses.depth_from_world[1]);
  EXPECT_GT(intersection_over_union(detection.masks.rgbd_color[1], expected), 0.95);
  EXPECT_FALSE(any_set(detection.masks.rgbd_depth[1]));
}

TEST_F(BoxOccluderOnPlate, WhatIsMissingIsReported) {
  const auto detector = make_detector(box_in("world"), rig);
  Detection detection = make_detection();
  detection.poses.depth_from_world = {std::nullopt, std::nullopt};
  EXPECT_EQ(detection.detect(*detector).message,
            "zone: where the box is from rgbd0 is not known, where the box is from rgbd1 is not "
            "known");
  EXPECT_FALSE(any_set(detection.masks.color));

  const auto elsewhere = make_detector(
      "{name: zone, detector: box, frame: rgbd1, min: [0, 0, 5], max: [1, 1, 6]}", rig);
  EXPECT_EQ(detection.detect(*elsewhere).message, "zone: no RGB-D camera sees anything inside");
}

TEST_F(BoxOccluderOnPlate, WrongSettingsAreNamed) {
  const auto error_with = [this](const std::string& settings) {
    return error_of([&] { make_detector("name: zone\ndetector: box\n" + settings, rig); });
  };
  EXPECT_THAT(error_with("frame: rgbd7\nmin: [0, 0, 0]\nmax: [1, 1, 1]"),
              HasSubstr("s.yaml:3: frame: expected one of world, rgbd0, rgbd1, got 'rgbd7'"));
  EXPECT_THAT(error_with("frame: world\nmin: [0, 2, 0]\nmax: [1, 1, 1]"),
              HasSubstr("s.yaml:5: max: expected three numbers, each above min's"));
  rig = without_depth(rig);
  EXPECT_THAT(error_with("frame: world\nmin: [0, 0, 0]\nmax: [1, 1, 1]"),
              HasSubstr("s.yaml:2: detector: box needs a camera that measures depth (rgbd)"));
}

}  // namespace
}  // namespace diminish
