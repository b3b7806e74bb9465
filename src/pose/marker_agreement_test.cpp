#include "pose/marker_agreement.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "diminish/occluder_settings.h"
#include "pose/marker_pose.h"

namespace diminish {
namespace {

constexpr double printed_m = 0.15;

/// Two markers at different distances, seen by the colour camera and by an RGB-D camera beside it.
class MarkerAgreementTest : public ::testing::Test {
 protected:
  MarkerAgreementTest() {
    rig.color = {.width = 1280, .height = 960, .fx = 1100, .fy = 1100, .cx = 640, .cy = 480};
    RgbdCamera camera;
    camera.name = "rgbd0";
    camera.color = {.width = 960, .height = 540, .fx = 530, .fy = 530, .cx = 480, .cy = 270};
    camera.color_from_depth.translation = {0.05, 0, 0};
    rig.rgbd.push_back(camera);
    scene.world_marker = {0, printed_m};
    auto on_object = std::make_shared<MarkerSettings>();
    on_object->marker = {1, printed_m};
    scene.occluders = {{"thing", "marker", on_object}};
    frame.rgbd.resize(1);
    frame.rgbd[0].color.own().resize(960, 540, Bgr{0, 0, 0});
    markers.rgbd.resize(1);
    color_from_depth.rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).toRotationMatrix();
    color_from_depth.translation = {-0.4, 0.05, 0.1};
    poses.color_from_depth = {color_from_depth};
    see(0, {0.1, 0.1, 1.6});
    see(1, {0.3, -0.1, 1.1});
  }

  /// center_m: in the depth sensor's frame, which the marker about faces.
  void see(int id, const Eigen::Vector3d& center_m) {
    const RigidTransform depth_from_marker = {
        (Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()))
            .toRotationMatrix(),
        center_m};
    markers.color.push_back(seen(id, color_from_depth * depth_from_marker, Lens(rig.color)));
    markers.rgbd[0].push_back(
        seen(id, rig.rgbd[0].color_from_depth * depth_from_marker, Lens(rig.rgbd[0].color)));
  }
  static Marker seen(int id, const RigidTransform& camera_from_marker, const Lens& lens) {
    Marker marker;
    marker.id = id;
    const auto corners = marker_corners(printed_m);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      marker.corners[i] = *lens.project(camera_from_marker * corners[i]);
    }
    return marker;
  }
  std::optional<MarkerShift> find() {
    std::vector<std::optional<MarkerShift>> found;
    MarkerAgreement(rig, scene).find(frame, markers, poses, found);
    return found.at(0);
  }

  Rig rig;
  Scene scene;
  FrameSet frame;
  Markers markers;
  Poses poses;
  RigidTransform color_from_depth;
};

TEST_F(MarkerAgreementTest, IsNearNothingWhereAllFits) {
  ASSERT_TRUE(find());
  EXPECT_LT(find()->shift, 0.1 * MarkerAgreement::tolerance);
}

TEST_F(MarkerAgreementTest, IsTheAngleByWhichTheCameraIsTurned) {
  const double angle = 0.03;
  const RigidTransform turn = {
      Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()).toRotationMatrix(),
      Eigen::Vector3d::Zero()};
  poses.color_from_depth[0] = turn * color_from_depth;
  EXPECT_NEAR(find()->shift, angle, 0.1 * angle);
}

TEST_F(MarkerAgreementTest, NamesTheMarkerThatIsShiftedMost) {
  for (Eigen::Vector2d& corner : markers.color[1].corners) corner.x() += 44;
  EXPECT_EQ(find()->marker, 1);
  EXPECT_NEAR(find()->shift, 44. / 1100, 0.002);
}

TEST_F(MarkerAgreementTest, IsUnknownWithoutAPoseOrACommonMarker) {
  poses.color_from_depth[0].reset();
  EXPECT_FALSE(find());
  poses.color_from_depth[0] = color_from_depth;
  markers.color.clear();
  EXPECT_FALSE(find());
}

}  // namespace
}  // namespace diminish
