#include "detect/occlusion_masks.h"

#include <gtest/gtest.h>

#include <set>

#include "detection.h"
#include "expect_error.h"
#include "mask_overlap.h"

namespace diminish {
namespace {

Rig rig_with_one_camera() {
  Rig rig;
  rig.color = {64, 48, 60, 60, 32, 24, {}};
  RgbdCamera camera;
  camera.name = "rgbd0";
  camera.color = {80, 60, 90, 90, 40, 30, {}};
  camera.depth = {32, 24, 30, 30, 16, 12, {}};
  rig.rgbd = {camera};
  return rig;
}

Scene scene_with(const std::string& occluders) {
  return read_scene(Config::parse("occluders: " + occluders, "scene.yaml"));
}

/// A mask of one pixel for an occluder in the colour image and in the RGB-D camera's.
GivenMask pixel(const std::string& occluder, const Rig& rig, int x, int y) {
  GivenMask mask{occluder,
                 Mask(rig.color.width, rig.color.height),
                 {Mask(rig.rgbd[0].color.width, rig.rgbd[0].color.height)}};
  mask.color(x, y) = 255;
  mask.rgbd[0](x, y) = 255;
  return mask;
}

TEST(OccluderStage, UnitesTheOccludersMasksAndGrowsThem) {
  Detection detection(rig_with_one_camera());
  detection.frame.masks = {pixel("a", detection.rig, 10, 10), pixel("b", detection.rig, 30, 20)};
  detection.options.mask_margin_px = 2;
  detection.options.rgbd_mask_margin_px = 3;
  OccluderStage stage(detection.rig, scene_with("[{name: a, detector: mask, color: x}, "
                                                "{name: b, detector: mask, color: y}]"));
  EXPECT_FALSE(stage.needs_markers());
  const OcclusionMasks& masks = stage.masks();
  std::vector<OccluderReport> reports;
  for (int frame = 0; frame < 2; ++frame) {  // the second one must not see the first one's masks
    stage.detect(detection.observation(), reports);
    ASSERT_EQ(reports.size(), 2u);
    EXPECT_EQ(reports[1].name, "b");
    EXPECT_TRUE(reports[1].in_color && reports[1].in_rgbd[0]);
    EXPECT_EQ(count_nonzero(masks.color, masks.color.bounds()), 2u * 13);
    EXPECT_EQ(masks.color(12, 10), 255);
    EXPECT_EQ(masks.color(28, 20), 255);
    EXPECT_EQ(count_nonzero(masks.rgbd_color[0], masks.rgbd_color[0].bounds()), 2u * 29);
    EXPECT_FALSE(any_set(masks.rgbd_depth[0]));
  }
  detection.options.mask_margin_px = 0;
  stage.detect(detection.observation(), reports);
  EXPECT_EQ(count_nonzero(masks.color, masks.color.bounds()), 2u);
}

/// A sign that moves along x in front of a camera that stands still.
class LostSign : public ::testing::Test {
 protected:
  static constexpr double speed_m_s = 0.4;

  Mask detect(OccluderStage& with, double stamp_s, bool is_seen) {
    detection.frame.stamp_s = stamp_s;
    detection.markers.color.clear();
    if (is_seen) {
      const Lens lens(detection.rig.color);
      const Eigen::Vector3d center(speed_m_s * stamp_s - 0.2, 0, 1);
      Marker marker{5, {}};
      const Eigen::Vector3d corners[] = {
          {-0.1, -0.1, 0}, {0.1, -0.1, 0}, {0.1, 0.1, 0}, {-0.1, 0.1, 0}};
      for (int i = 0; i < 4; ++i) marker.corners[i] = lens.project(center + corners[i]).value();
      detection.markers.color = {marker};
    }
    with.detect(detection.observation(), reports);
    return with.masks().color;
  }

  Detection detection = [] {
    Detection with_poses(rig_with_one_camera());
    with_poses.options.memory = "on";
    with_poses.poses.color_from_world = RigidTransform{};
    with_poses.poses.color_from_depth[0] = RigidTransform{};
    return with_poses;
  }();
  const Scene scene = scene_with(
      "[{name: sign, detector: marker, marker: {id: 5, size_m: 0.2}, vertices: [[-0.1, -0.1, 0], "
      "[0.1, -0.1, 0], [0.1, 0.1, 0], [-0.1, 0.1, 0]]}]");
  OccluderStage stage{detection.rig, scene}, other{detection.rig, scene};
  std::vector<OccluderReport> reports;
};

TEST_F(LostSign, GoesOnForAMoment) {
  other.share(stage);  // every other frame is the other's
  for (const double stamp_s : {0., 0.2}) {
    detect(stage, stamp_s, true);
    detect(other, stamp_s + 0.1, true);
    EXPECT_EQ(reports[0].message, "");
  }
  OccluderStage alone(detection.rig, scene);
  const Mask expected = detect(alone, 0.6, true);
  EXPECT_GT(intersection_over_union(detect(stage, 0.6, false), expected), 0.95);
  EXPECT_TRUE(reports[0].in_color);
  EXPECT_EQ(reports[0].message,
            "sign: marker 5 not visible in any camera; continued by its last motion");
  EXPECT_FALSE(any_set(detect(stage, 0.9, false)));
  EXPECT_EQ(reports[0].message, "sign: marker 5 not visible in any camera");
}

TEST_F(LostSign, IsLostAtOnceWithoutMemory) {
  detection.options.memory = "off";
  detect(stage, 0, true);
  detect(stage, 0.1, true);
  EXPECT_FALSE(any_set(detect(stage, 0.2, false)));
}

TEST(OccluderStage, TheDepthMasksMarginCoversTheSameAngle) {
  Detection detection(rig_with_one_camera());
  Image<std::uint16_t>& depth = detection.frame.rgbd[0].depth.own();
  depth(15, 10) = 1000;
  const std::string box =
      "[{name: zone, detector: box, frame: rgbd0, min: [-5, -5, 0.5], max: [5, 5, 2]}]";
  OccluderStage stage(detection.rig, scene_with(box));
  const OcclusionMasks& masks = stage.masks();
  std::vector<OccluderReport> reports;
  for (const auto& [margin_px, pixels] : {std::pair{0, 1}, {1, 5}, {3, 5}, {4, 13}, {6, 13}}) {
    detection.options.rgbd_mask_margin_px = margin_px;
    stage.detect(detection.observation(), reports);
    EXPECT_EQ(count_nonzero(masks.rgbd_depth[0], masks.rgbd_depth[0].bounds()),
              static_cast<std::size_t>(pixels));
  }
}

/// A drawer that fails in every frame like a GPU.
class BrokenDrawer : public MaskDrawer {
 public:
  static inline int made = 0;
  BrokenDrawer() { ++made; }
  void draw(std::span<MaskDrawing>) override { throw Error("the driver lost the context"); }
};

TEST(OccluderStage, WhereTheGpuFailsTheCpuDraws) {
  Registry<MaskDrawer>::add("broken", [] { return std::make_unique<BrokenDrawer>(); });
  Detection detection(rig_with_one_camera());
  detection.frame.masks = {pixel("a", detection.rig, 10, 10)};
  detection.options.mask_margin_px = 2;
  OccluderStage stage(detection.rig, scene_with("[{name: a, detector: mask, color: x}]"));
  stage.draw_by("broken");
  const OcclusionMasks& masks = stage.masks();
  std::vector<OccluderReport> reports;
  // It is set up again at once, then after one, three, seven frames and so on.
  const std::set<int> attempts{1, 2, 4, 8, 16};
  int made = 0;
  for (int frame = 1; frame <= 16; ++frame) {
    stage.detect(detection.observation(), reports);
    made += static_cast<int>(attempts.count(frame));
    EXPECT_EQ(count_nonzero(masks.color, masks.color.bounds()), 13U);
    EXPECT_EQ(stage.message(), "the driver lost the context; masks were drawn by the CPU instead");
    EXPECT_EQ(BrokenDrawer::made, made) << frame;
  }
  stage.draw_by("cpu");
  stage.detect(detection.observation(), reports);
  EXPECT_EQ(stage.message(), "");
}

TEST(OccluderStage, AnUnknownDetectorIsNamed) {
  EXPECT_THAT(
      error_of(
          [] { OccluderStage(rig_with_one_camera(), scene_with("[{name: a, detector: magic}]")); }),
      ::testing::MatchesRegex("scene.yaml:1: .*detector: expected one of .*marker.*, got 'magic'"));
}

TEST(OccluderStage, AFrameWithoutAGivenMaskIsReported) {
  Detection detection(rig_with_one_camera());
  OccluderStage stage(detection.rig, scene_with("[{name: a, detector: mask, color: x}]"));
  const OcclusionMasks& masks = stage.masks();
  std::vector<OccluderReport> reports;
  stage.detect(detection.observation(), reports);
  EXPECT_EQ(reports.at(0).message, "a: no mask for the colour image of this frame");
  EXPECT_FALSE(any_set(masks.color));
}

}  // namespace
}  // namespace diminish
