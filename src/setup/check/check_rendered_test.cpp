#include <fmt/printf.h>
#include <gmock/gmock.h>

#include <cmath>

#include "diminish/setup_check.h"
#include "rendered_targets.h"

namespace diminish {
namespace {

constexpr double period_s = 1.0 / 30;
constexpr int frame_count = 24;

/// Two cameras, a world marker on a wall, and a marker that is waved in front of it.
struct WavedMarker {
  WavedMarker() {
    rig.color = {480, 384, 424, 424, 241, 190, {-0.11, 0.09, 0.0006, -0.0004, 0}};
    RgbdCamera camera;
    camera.name = "rgbd0";
    camera.color = {480, 384, 400, 400, 239, 192, {}};
    camera.depth = {160, 132, 115, 115, 79, 65, {}};
    camera.color_from_depth.translation = {0.05, 0, 0};
    rig.rgbd.push_back(camera);
    scene = read_scene(
        Config::parse("world_marker: {id: 0, size_m: 0.2}\n"
                      "occluders: [{name: a, detector: marker, marker: {id: 1, size_m: 0.15}, "
                      "vertices: [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]}]\n"));
    const testing::TargetRenderer color(rig.color);
    const testing::TargetRenderer rgbd_color(camera.color);
    const testing::TargetRenderer depth(camera.depth);
    RigidTransform color_from_world;
    color_from_world.rotation =
        Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitY()).toRotationMatrix() *
        Eigen::Vector3d(1, -1, -1).asDiagonal();
    color_from_world.translation = {0.1, 0, 1.1};
    RigidTransform depth_from_world;
    depth_from_world.rotation =
        Eigen::AngleAxisd(-0.4, Eigen::Vector3d(0.3, 1, 0).normalized()).toRotationMatrix() *
        Eigen::Vector3d(1, -1, -1).asDiagonal();
    depth_from_world.translation = {-0.05, 0.05, 1.0};
    for (int i = 0; i < frame_count; ++i) {
      const double t = i * period_s;
      RigidTransform waved;
      waved.translation = {0.27 + 0.06 * std::sin(7 * t), 0.1 * std::sin(11 * t), 0.1};
      const std::vector<testing::Target> targets = {testing::marker_target(0, 0.2, {}),
                                                    testing::marker_target(1, 0.15, waved)};
      FrameSet frame;
      const auto seed = static_cast<unsigned>(i);
      frame.color = color.color(targets, color_from_world, 0.6, 2, seed);
      frame.rgbd.resize(1);
      frame.rgbd[0].color =
          rgbd_color.color(targets, camera.color_from_depth * depth_from_world, 0.6, 2, seed + 100);
      frame.rgbd[0].depth = depth.depth(targets, depth_from_world, 0.001, 0.002, seed + 200);
      frames.push_back(std::move(frame));
    }
  }

  Rig rig;
  Scene scene;
  std::vector<FrameSet> frames;  ///< images of the same moment
};

/// The frames as a recording pairs them if the RGB-D camera's clock is ahead by `late` frames.
class PairedByStamps final : public FrameSource {
 public:
  PairedByStamps(const WavedMarker& waved, int late) : waved_(waved), late_(late) {}

  bool next(FrameSet& frame) override {
    const int count = static_cast<int>(waved_.frames.size());
    if (next_ == count) return false;
    frame = waved_.frames[static_cast<std::size_t>(next_)];
    frame.name = fmt::format("{}", next_);
    frame.stamp_s = 100 + next_ * period_s;
    const int partner = next_ - late_;
    if (partner >= 0 && partner < count) {
      frame.rgbd[0] = waved_.frames[static_cast<std::size_t>(partner)].rgbd[0];
      frame.rgbd[0].color_stamp_s = frame.rgbd[0].depth_stamp_s = frame.stamp_s;
    } else {
      frame.rgbd[0] = {};
      frame.rgbd[0].missing = "rgbd0: no color image within 0.017 s";
    }
    ++next_;
    return true;
  }

 private:
  const WavedMarker& waved_;
  int late_;
  int next_ = 0;
};

TEST(CheckSetup, FindsAClockOffsetByAWavedMarker) {
  const WavedMarker waved;
  PairedByStamps together(waved, 0);
  const SetupReport fine = check_setup(waved.rig, waved.scene, together);
  EXPECT_TRUE(fine.fine()) << setup_report_text(fine);
  EXPECT_THAT(setup_report_text(fine), ::testing::HasSubstr("clock of rgbd0 minus color's"));
  for (const int late : {2, -2}) {
    PairedByStamps apart(waved, late);
    const SetupReport report = check_setup(waved.rig, waved.scene, apart);
    ASSERT_EQ(report.findings.size(), 1U) << setup_report_text(report);
    EXPECT_EQ(report.findings[0].code, "clock-offset");
    EXPECT_THAT(report.findings[0].what,
                ::testing::HasSubstr(late > 0 ? "ahead of color's" : "behind color's"));
    for (const SetupFigure& figure : report.figures) {
      if (figure.name != "clock of rgbd0 minus color's") continue;
      RecordProperty("figures", fmt::sprintf("clock offset %.1f ms, truth %.1f ms", figure.value,
                                             late * 1000 * period_s));
      EXPECT_NEAR(figure.value, late * 1000 * period_s, 10);
    }
  }
}

/// One frame, again and again.
class OneFrame final : public FrameSource {
 public:
  explicit OneFrame(const FrameSet& frame) : frame_(frame) {}
  bool next(FrameSet& frame) override {
    frame = frame_;
    frame.stamp_s = count_ * period_s;
    return ++count_ <= 3;
  }

 private:
  const FrameSet& frame_;
  int count_ = 0;
};

class SmallMarker : public ::testing::TestWithParam<double> {};

// Sizes that the detector just finds, and sizes that it no longer finds.
TEST_P(SmallMarker, IsSaid) {
  const double distance_m = GetParam();
  Rig rig;
  rig.color = {480, 384, 424, 424, 241, 190, {}};
  RgbdCamera camera;
  camera.name = "rgbd0";
  camera.color = rig.color;
  camera.depth = {160, 132, 115, 115, 79, 65, {}};
  rig.rgbd.push_back(camera);
  const Scene scene = read_scene(
      Config::parse("world_marker: {id: 0, size_m: 0.055}\n"
                    "occluders: [{name: a, detector: box, frame: world, min: [0, 0, 0], max: [1, "
                    "1, 1]}]\n"));
  RigidTransform far;
  far.rotation = Eigen::Vector3d(1, -1, -1).asDiagonal();
  far.translation = {0.02, 0.01, distance_m};
  RigidTransform near = far;
  near.translation.z() = 0.4;
  const std::vector<testing::Target> targets = {testing::marker_target(0, 0.055, {})};
  const testing::TargetRenderer renderer(rig.color);
  FrameSet frame;
  frame.color = renderer.color(targets, far, 0.4, 1, 1);
  frame.rgbd.resize(1);
  frame.rgbd[0].color = renderer.color(targets, near, 0.4, 1, 2);
  frame.rgbd[0].depth = testing::TargetRenderer(camera.depth).depth(targets, near, 0.001, 0.001, 3);
  OneFrame source(frame);
  const SetupReport report = check_setup(rig, scene, source);
  ASSERT_EQ(report.findings.size(), 1U) << setup_report_text(report);
  EXPECT_EQ(report.findings[0].code, "marker-small");
  EXPECT_THAT(report.findings[0].what, ::testing::HasSubstr("small in color"));
  const double side_px = rig.color.fx * 0.055 / distance_m;
  EXPECT_NEAR(std::stod(report.findings[0].figure), side_px, 1.5) << report.findings[0].figure;
}

INSTANTIATE_TEST_SUITE_P(Sizes, SmallMarker, ::testing::Values(0.65, 1.05));

}  // namespace
}  // namespace diminish
