#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "diminish/frame_source.h"
#include "estimate/depth_estimation.h"
#include "estimate/feature_planes.h"
#include "estimate/plane_depth.h"
#include "expect_error.h"
#include "paths.h"
#include "truth_poses.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

TEST(InversePlane, KeepsItsPointsInAnotherCamera) {
  const Eigen::Vector3d point(0.3, -0.2, 2);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.2, 0.5, -1).normalized();
  const InversePlane plane = InversePlane::through(point, normal);
  EXPECT_NEAR(plane.inverse.dot(point), 1, 1e-12);
  RigidTransform from_other;
  from_other.rotation =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  from_other.translation = {0.1, 0.2, -0.3};
  const InversePlane there = transformed(plane, from_other);
  EXPECT_NEAR(there.inverse.dot(from_other.inverse() * point), 1, 1e-12);
}

TEST(PlaneDepth, IsTheNearestPlaneAlongEachRay) {
  const Intrinsics view{.width = 64, .height = 48, .fx = 60, .fy = 62, .cx = 31, .cy = 22};
  // A wall, a floor in front of it, and a plane behind the camera
  const std::vector<InversePlane> planes = {InversePlane::through({0, 0, 3}, {0.1, 0, -1}),
                                            InversePlane::through({0, 0.8, 0}, {0, -1, 0}),
                                            InversePlane::through({0, 0, -1}, {0, 0, 1})};
  Image<std::uint16_t> depth(view.width, view.height, 7);
  draw_planes(planes, view, 0.0005, depth);
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const double a = (x - view.cx) / view.fx;
      const double b = (y - view.cy) / view.fy;
      // By intersecting the ray
      double nearest = 3 / (1 - 0.1 * a);
      if (b > 0) nearest = std::min(nearest, 0.8 / b);
      ASSERT_NEAR(depth(x, y) * 0.0005, nearest, 0.0004) << x << ' ' << y;
    }
  }
}

TEST(PlaneDepth, APlaneMayEnd) {
  const Intrinsics view{.width = 80, .height = 60, .fx = 70, .fy = 70, .cx = 40.2, .cy = 29.7};
  // A slanted card in front of a wall
  InversePlane card = InversePlane::through({0, 0, 1.5}, {0.3, 0, -1});
  card.corners = {{-0.3, -0.2, 1.41}, {0.4, -0.1, 1.62}, {0.2, 0.4, 1.56}, {-0.2, 0.3, 1.44}};
  Image<std::uint16_t> depth(view.width, view.height);
  draw_planes({InversePlane::through({0, 0, 3}, {0, 0, -1}), card}, view, 0.0005, depth);
  const auto is_inside = [&](int x, int y) {
    // Its corners' pixels, by the sides of a polygon
    for (std::size_t i = 0; i < 4; ++i) {
      const auto pixel = [&](const Eigen::Vector3d& p) {
        return Eigen::Vector2d(view.fx * p.x() / p.z() + view.cx,
                               view.fy * p.y() / p.z() + view.cy);
      };
      const Eigen::Vector2d a = pixel(card.corners[i]);
      const Eigen::Vector2d along = pixel(card.corners[(i + 1) % 4]) - a;
      if (along.x() * (y - a.y()) - along.y() * (x - a.x()) < 0) return false;
    }
    return true;
  };
  int inside = 0;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const double z = is_inside(x, y) ? 1.5 / (1 - 0.3 * (x - view.cx) / view.fx) : 3;
      inside += is_inside(x, y) ? 1 : 0;
      ASSERT_NEAR(depth(x, y) * 0.0005, z, 0.0004) << x << ' ' << y;
    }
  }
  EXPECT_GT(inside, 300);
}

TEST(PlaneDepth, APartMayReachBehindTheCamera) {
  const Intrinsics view{.width = 40, .height = 40, .fx = 40, .fy = 40, .cx = 19.5, .cy = 19.5};
  // A floor from 3 m behind the camera to 2 m in front of it
  InversePlane floor = InversePlane::through({0, 0.5, 0}, {0, -1, 0});
  floor.corners = {{-5, 0.5, 2}, {5, 0.5, 2}, {5, 0.5, -3}, {-5, 0.5, -3}};
  Image<std::uint16_t> depth(40, 40);
  draw_planes({floor}, view, 0.0005, depth);
  for (int y = 0; y < 40; ++y) {
    const double z = y > view.cy ? 0.5 * view.fy / (y - view.cy) : 1e9;
    for (int x = 0; x < 40; ++x)
      ASSERT_NEAR(depth(x, y) * 0.0005, z <= 2 ? z : 0, 0.0004) << x << ' ' << y;
  }
}

TEST(PlaneDepth, WhereThereIsNoPlaneNothingIsKnown) {
  const Intrinsics view{.width = 20, .height = 20, .fx = 20, .fy = 20, .cx = 9.5, .cy = 9.5};
  Image<std::uint16_t> depth(20, 20, 7);
  draw_planes({InversePlane::through({0, 1, 0}, {0, -1, 0})}, view, 0.0005, depth);
  EXPECT_EQ(depth(10, 2), 0);
  EXPECT_NE(depth(10, 18), 0);
  draw_planes({}, view, 0.0005, depth);
  EXPECT_EQ(depth(10, 18), 0);
}

/// As drawing it tells.
TEST(PlaneDepth, InViewIsWhatWouldBeDrawn) {
  const Intrinsics view{.width = 40, .height = 30, .fx = 40, .fy = 40, .cx = 19.5, .cy = 14.5};
  const auto part = [](double x, double y, double z) {
    InversePlane plane = InversePlane::through({0, 0, z}, {0, 0, -1});
    plane.corners = {{x, y, z}, {x + 1, y, z}, {x + 1, y + 1, z}, {x, y + 1, z}};
    return plane;
  };
  const InversePlane wall = InversePlane::through({0, 0, 2}, {0.2, 0, -1});
  const InversePlane behind = InversePlane::through({0, 0, -1}, {0, 0.1, 1});
  const InversePlane floor = InversePlane::through({0, 1, 0}, {0, -1, 0});
  const InversePlane too_far = InversePlane::through({0, 0, 200}, {0, 0, -1});
  int in_view = 0;
  for (const InversePlane& plane :
       {wall, behind, floor, too_far, part(-0.5, -0.5, 2), part(0.95, 0, 2), part(1.1, 0, 2),
        part(0, -1.9, 2), part(-2.1, 0, 2), part(0, 0, -2)}) {
    Image<std::uint16_t> depth(view.width, view.height, 0);
    draw_planes({plane}, view, 0.001, depth);
    const bool is_drawn =
        std::any_of(depth.begin(), depth.end(), [](std::uint16_t value) { return value != 0; });
    EXPECT_EQ(is_in_view(plane, view, 0.001), is_drawn) << plane.inverse.transpose();
    in_view += is_drawn ? 1 : 0;
  }
  EXPECT_EQ(in_view, 4);
}

/// The bundled calendar, whose wall is the world marker's plane, without its depth.
struct Wall {
  explicit Wall(const std::string& planes)
      : recording(load_recording(std::filesystem::path(testing::recordings_dir()) / "calendar")) {
    measured = recording.rig;
    recording.rig = without_depth(recording.rig);
    const Scene scene = read_scene(
        Config::parse("occluders: [{name: a, detector: difference}]\n" + planes, "scene.yaml"));
    recording.scene.planes = scene.planes;
    open_recording(recording, options)->next(frame);
    // The exact pose of the colour sensor, whose place the depth image has
    poses = TruthPoses(recording.folder).poses(0, measured);
    poses.depth_from_world[0] = measured.rgbd[0].color_from_depth * *poses.depth_from_world[0];
    poses.color_from_depth[0] = *poses.color_from_world * poses.depth_from_world[0]->inverse();
    masks.color.resize(measured.color.width, measured.color.height, 0);
    masks.rgbd_color.emplace_back(measured.rgbd[0].color.width, measured.rgbd[0].color.height,
                                  std::uint8_t{0});
    markers.rgbd.resize(1);
  }

  ImageView<std::uint16_t> estimate() {
    estimation = std::make_unique<DepthEstimation>(recording.rig, recording.scene);
    estimation->choose("auto");
    const FrameSet& completed = estimation->begin(frame);
    estimation->estimate(markers, poses, masks, recording.rig.color.bounds(), options);
    return completed.rgbd[0].depth;
  }
  /// How far the depth's point at a pixel is from the wall, metres.
  double distance_m(ImageView<std::uint16_t> depth, int x, int y) const {
    const RgbdCamera& camera = recording.rig.rgbd[0];
    const double z = depth(x, y) * camera.depth_unit_m;
    const Eigen::Vector3d point((x - camera.depth.cx) / camera.depth.fx * z,
                                (y - camera.depth.cy) / camera.depth.fy * z, z);
    return std::abs((poses.depth_from_world[0]->inverse() * point).z());
  }

  Recording recording;
  Rig measured;
  Options options;
  FrameSet frame;
  Poses poses;
  OcclusionMasks masks;
  Markers markers;
  std::unique_ptr<DepthEstimation> estimation;
};

TEST(PlanesEstimator, DrawsAPlaneOfTheWorld) {
  Wall wall("planes: [{point: [0, 0, 0], normal: [0, 0, 1]}]\n");
  const ImageView<std::uint16_t> depth = wall.estimate();
  for (const auto& [x, y] : {std::pair{100, 100}, {300, 200}, {400, 60}}) {
    ASSERT_NE(depth(x, y), 0);
    EXPECT_LT(wall.distance_m(depth, x, y), 0.001);
  }
}

TEST(PlanesEstimator, AMarkerLiesOnAPlane) {
  Wall wall("planes: [{marker: {id: 3, size_m: 0.2}}]\n");
  // As the RGB-D camera sees it, on the wall
  Marker marker{3, {}};
  const double half = 0.1;
  const Eigen::Vector3d corners[] = {
      {0.2 - half, half, 0}, {0.2 + half, half, 0}, {0.2 + half, -half, 0}, {0.2 - half, -half, 0}};
  for (std::size_t i = 0; i < 4; ++i) {
    marker.corners[i] = Lens(wall.recording.rig.rgbd[0].color)
                            .project(*wall.poses.depth_from_world[0] * corners[i])
                            .value();
  }
  wall.markers.rgbd[0] = {marker};
  const ImageView<std::uint16_t> depth = wall.estimate();
  EXPECT_LT(wall.distance_m(depth, 300, 200), 0.002);
  EXPECT_TRUE(wall.estimation->messages().empty());

  wall.markers.rgbd[0].clear();
  wall.estimate();
  ASSERT_EQ(wall.estimation->messages().size(), 1U);
  EXPECT_EQ(wall.estimation->messages()[0], "planes: marker 3 is in no picture");
}

TEST(PlanesEstimator, WithoutAWorldItSaysSo) {
  Wall wall("planes: [{point: [0, 0, 0], normal: [0, 0, 1]}]\n");
  wall.poses.color_from_world.reset();
  EXPECT_EQ(wall.estimate()(300, 200), 0);
  ASSERT_EQ(wall.estimation->messages().size(), 1U);
  EXPECT_EQ(wall.estimation->messages()[0], "planes: where the world is, is not known");
}

/// Behind the camera; a part beside its picture.
TEST(PlanesEstimator, APlaneOutOfViewIsSaid) {
  for (const std::string plane : {"{corners: [[0, 0, 6], [1, 0, 6], [1, 1, 6], [0, 1, 6]]}",
                                  "{corners: [[40, 0, 0], [41, 0, 0], [41, 1, 0], [40, 1, 0]]}"}) {
    SCOPED_TRACE(plane);
    Wall wall("planes: [{point: [0, 0, 0], normal: [0, 0, 1]}, " + plane + "]\n");
    const ImageView<std::uint16_t> depth = wall.estimate();
    EXPECT_LT(wall.distance_m(depth, 300, 200), 0.001);
    ASSERT_EQ(wall.estimation->messages().size(), 1U);
    EXPECT_EQ(
        wall.estimation->messages()[0],
        "planes[1]: no camera that is used sees it: it is behind them or out of their pictures");
  }
}

TEST(PlanesEstimator, FindsTheWallByItsFeatures) {
  Wall wall("planes: [{features: 1}]\n");
  const ImageView<std::uint16_t> depth = wall.estimate();
  EXPECT_TRUE(wall.estimation->messages().empty());
  EXPECT_LT(wall.distance_m(depth, 300, 120), 0.02);
}

TEST(PlanesEstimator, WhatIsNoPlaneIsNamed) {
  const auto complaint = [](const std::string& plane) {
    return error_of([&] {
      read_scene(Config::parse(
          "occluders: [{name: a, detector: difference}]\nplanes: [" + plane + "]\n", "scene.yaml"));
    });
  };
  EXPECT_THAT(complaint("{point: [0, 0, 0], normal: [0, 0, 0]}"),
              HasSubstr("planes[0].normal: expected a direction, got a vector without length"));
  EXPECT_THAT(complaint("{point: [0, 0, 0]}"), HasSubstr("planes[0]: missing key 'normal'"));
  EXPECT_THAT(complaint("{corners: [[0, 0, 0], [1, 0, 0]]}"), HasSubstr("expected 3 to 8 corners"));
  EXPECT_THAT(
      complaint("{corners: [[0, 0, 0], [1, 0, 0], [2, 0, 0]]}"),
      HasSubstr(
          "planes[0].corners: expected corners in their order around the part, not on one line"));
  EXPECT_THAT(complaint("{corners: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.5]]}"),
              HasSubstr("planes[0].corners: expected corners of one plane"));
  EXPECT_THAT(complaint("{corners: [[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]]}"),
              HasSubstr("planes[0].corners: expected corners"));
  EXPECT_THAT(complaint("{features: 0}"), HasSubstr("planes[0].features"));
  EXPECT_THAT(complaint("{features: 1, point: [0, 0, 0]}"), HasSubstr("planes[0]"));
}

TEST(PlanesEstimator, NeedsPlanes) {
  const Wall wall("");
  DepthEstimation estimation(wall.recording.rig, wall.recording.scene);
  EXPECT_EQ(error_of([&] { estimation.choose("planes"); }),
            "estimate_depth planes: expected planes in scene.yaml");
}

}  // namespace
}  // namespace diminish
