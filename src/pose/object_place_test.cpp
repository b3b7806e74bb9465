#include "pose/object_place.h"

#include <gtest/gtest.h>

#include "analytic_scene.h"
#include "diminish/occluder_settings.h"
#include "pose/marker_pose.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

constexpr double panel_marker_m = 0.12;
const Eigen::Vector3d panel_min{-0.15, -0.1, 0.38};
const Eigen::Vector3d panel_max{0.15, 0.1, 0.4};
const Eigen::Vector3d marker_at{0, 0, 0.4};

/// A thin panel with a marker on its front, which the colour camera faces and an RGB-D camera sees
/// from the side.
class ObjectPlaceTest : public ::testing::Test {
 protected:
  ObjectPlaceTest()
      : frame(AnalyticScene{.box_min = panel_min, .box_max = panel_max},
              {Eigen::Vector3d(-0.8, 0.3, 0.9)}),
        settings(std::make_shared<MarkerSettings>()) {
    for (const double x : {panel_min.x(), panel_max.x()}) {
      for (const double y : {panel_min.y(), panel_max.y()}) {
        for (const double z : {panel_min.z(), panel_max.z()}) {
          settings->vertices.emplace_back(Eigen::Vector3d(x, y, z) - marker_at);
        }
      }
    }
    settings->marker = {1, panel_marker_m};
    scene.occluders = {{"panel", "marker", settings}};
    Marker marker;
    marker.id = 1;
    const auto corners = marker_corners(panel_marker_m);
    const Lens lens(frame.rig.color);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      marker.corners[i] = *lens.project(*frame.poses.color_from_world * (corners[i] + marker_at));
    }
    markers.color = {marker};
    markers.rgbd.resize(1);
  }

  /// With the marker's size as it is said.
  std::optional<PlaceOfObject> find(double said_m) {
    settings->marker.size_m = said_m;
    std::vector<std::optional<PlaceOfObject>> found;
    ObjectPlace(frame.rig, scene).find(frame.frame, markers, frame.poses, found);
    return found.at(0);
  }

  AnalyticFrame frame;
  std::shared_ptr<MarkerSettings> settings;
  Scene scene;
  Markers markers;
};

TEST_F(ObjectPlaceTest, IsRight) {
  for (const double said : {0.98, 1., 1.02}) {
    const auto place = find(said * panel_marker_m);
    ASSERT_TRUE(place);
    EXPECT_EQ(place->marker, 1);
    EXPECT_LT(place->seen_through, 0.05);
    EXPECT_LT(place->covered, 0.05);
    EXPECT_FALSE(place->is_wrong());
  }
}

TEST_F(ObjectPlaceTest, IsBeforeWhatTheDepthCameraMeasures) {
  const auto place = find(0.9 * panel_marker_m);
  ASSERT_TRUE(place);
  EXPECT_GT(place->seen_through, 0.9);
  EXPECT_TRUE(place->is_wrong());
}

TEST_F(ObjectPlaceTest, IsBehindItself) {
  const auto place = find(1.1 * panel_marker_m);
  ASSERT_TRUE(place);
  EXPECT_GT(place->covered, 0.9);
  EXPECT_TRUE(place->is_wrong());
}

TEST_F(ObjectPlaceTest, IsKnownOfMeshes) {
  settings->triangles = {{0, 1, 2}, {1, 3, 2}, {4, 6, 5}, {5, 6, 7}, {0, 4, 1}, {1, 4, 5},
                         {2, 3, 6}, {3, 7, 6}, {0, 2, 4}, {2, 6, 4}, {1, 5, 3}, {3, 5, 7}};
  ASSERT_TRUE(find(panel_marker_m));
  EXPECT_FALSE(find(panel_marker_m)->is_wrong());
  EXPECT_TRUE(find(0.9 * panel_marker_m)->is_wrong());
  EXPECT_TRUE(find(1.1 * panel_marker_m)->is_wrong());
}

TEST_F(ObjectPlaceTest, IsUnknownWhereACameraDoesNotLook) {
  const Markers seen = markers;
  markers.color.clear();
  EXPECT_FALSE(find(panel_marker_m));
  markers = seen;
  frame.frame.rgbd[0].depth.own().fill(0);
  EXPECT_FALSE(find(panel_marker_m));
  frame.frame.rgbd[0].depth = {};
  EXPECT_FALSE(find(panel_marker_m));
}

}  // namespace
}  // namespace diminish
