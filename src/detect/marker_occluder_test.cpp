#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "detection.h"
#include "expect_error.h"
#include "mask_overlap.h"
#include "paths.h"
#include "truth_poses.h"

namespace diminish {
namespace {

using testing::recordings;

/// The marker of a recording's only occluder, and where it is in the occluder's frame.
struct RecordedMarker {
  std::string recording;
  std::string occluder;
  MarkerSpec marker;
  Eigen::Vector3d offset_m;
};
const RecordedMarker recorded[] = {{"calendar", "calendar", {1, 0.12}, {0, 0.06, 0.0005}},
                                   {"workbench", "lamp", {2, 0.1}, {0, 0.085, 0.0308}}};

Marker project(const MarkerSpec& marker, const RigidTransform& camera_from_marker,
               const Intrinsics& intrinsics) {
  const double half = marker.size_m / 2;
  const Eigen::Vector3d square[] = {
      {-half, half, 0}, {half, half, 0}, {half, -half, 0}, {-half, -half, 0}};
  Marker seen{marker.id, {}};
  for (int i = 0; i < 4; ++i) {
    seen.corners[i] = Lens(intrinsics).project(camera_from_marker * square[i]).value();
  }
  return seen;
}

class MarkerOccluderOnRecordings : public ::testing::TestWithParam<RecordedMarker> {};

/// truth/mask shows what the colour camera sees of the object, which nothing hides here.
TEST_P(MarkerOccluderOnRecordings, DrawsTheTruth) {
  const auto& [name, occluder, marker, offset_m] = GetParam();
  const Recording recording = load_recording(recordings / name);
  const TruthPoses truth(recording.folder);
  const OccluderSpec& spec = recording.scene.occluders.at(0);
  const auto detector = Registry<OccluderDetector>::get(spec.detector).make(spec, recording.rig);
  EXPECT_TRUE(detector->needs_markers());
  Detection detection(recording.rig);
  const RgbdCamera& first = recording.rig.rgbd[0];
  ASSERT_GT(truth.size(), 0u);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    SCOPED_TRACE(truth.frame(i));
    detection.poses = truth.poses(i, recording.rig);
    const RigidTransform world_from_marker = truth.world_from_occluder(i, occluder) *
                                             RigidTransform{Eigen::Matrix3d::Identity(), offset_m};
    const Mask expected =
        read_mask_image(recording.folder / "truth" / "mask" / (truth.frame(i) + ".png"));

    // Seen by the colour camera.
    const RigidTransform color_from_marker = *detection.poses.color_from_world * world_from_marker;
    detection.markers.color = {project(marker, color_from_marker, recording.rig.color)};
    detection.markers.rgbd[0] = {};
    const OccluderReport direct = detection.detect(*detector);
    EXPECT_TRUE(direct.in_color);
    EXPECT_TRUE(direct.in_rgbd[0]);
    EXPECT_EQ(direct.message, "");
    EXPECT_GT(intersection_over_union(detection.masks.color, expected), 0.97);
    const Mask in_rgbd_color = detection.masks.rgbd_color[0];
    const Mask in_rgbd_depth = detection.masks.rgbd_depth[0];

    // Seen by the first RGB-D camera only.
    const RigidTransform rgbd_from_marker =
        first.color_from_depth * *detection.poses.depth_from_world[0] * world_from_marker;
    detection.markers.color = {};
    detection.markers.rgbd[0] = {project(marker, rgbd_from_marker, first.color)};
    EXPECT_TRUE(detection.detect(*detector).in_color);
    EXPECT_GT(intersection_over_union(detection.masks.color, expected), 0.97);
    EXPECT_GT(intersection_over_union(detection.masks.rgbd_color[0], in_rgbd_color), 0.99);
    EXPECT_GT(intersection_over_union(detection.masks.rgbd_depth[0], in_rgbd_depth), 0.98);
  }
}

INSTANTIATE_TEST_SUITE_P(Recordings, MarkerOccluderOnRecordings, ::testing::ValuesIn(recorded),
                         [](const auto& test) { return test.param.recording; });

Rig small_rig() {
  Rig rig;
  rig.color = {320, 240, 300, 300, 160, 120, {}};
  RgbdCamera camera;
  camera.name = "rgbd0";
  camera.color = {320, 180, 280, 280, 160, 90, {}};
  camera.depth = {128, 106, 90, 90, 64, 53, {}};
  camera.color_from_depth.translation = {0.05, 0, 0};
  rig.rgbd = {camera};
  return rig;
}

const std::string square =
    "{name: sign, detector: marker, marker: {id: 5, size_m: 0.1}, "
    "vertices: [[-0.1, -0.1, 0], [0.1, -0.1, 0], [0.1, 0.1, 0], [-0.1, 0.1, 0]]}";
const MarkerSpec square_marker{5, 0.1};
const RigidTransform in_front{Eigen::AngleAxisd(2.8, Eigen::Vector3d::UnitX()).toRotationMatrix(),
                              {0, 0, 1}};

TEST(MarkerOccluder, AMarkerThatNoCameraSeesIsReported) {
  const auto detector = make_detector(square, small_rig());
  Detection detection(small_rig());
  detection.markers.color = {project({6, 0.1}, in_front, detection.rig.color)};
  const OccluderReport report = detection.detect(*detector);
  EXPECT_EQ(report.name, "sign");
  EXPECT_EQ(report.message, "sign: marker 5 not visible in any camera");
  EXPECT_FALSE(report.in_color);
  EXPECT_EQ(report.in_rgbd, std::vector<bool>{false});
  EXPECT_FALSE(any_set(detection.masks.color));
}

TEST(MarkerOccluder, ACameraWithoutAPoseIsReported) {
  const auto detector = make_detector(square, small_rig());
  Detection detection(small_rig());
  detection.markers.color = {project(square_marker, in_front, detection.rig.color)};
  const OccluderReport report = detection.detect(*detector);
  EXPECT_TRUE(report.in_color);
  EXPECT_FALSE(report.in_rgbd[0]);
  EXPECT_EQ(report.message,
            "sign: marker 5 not visible in rgbd0 color, and the way there from a camera that sees "
            "it is not known");
}

TEST(MarkerOccluder, ACameraWithoutImagesIsLeftAlone) {
  const auto detector = make_detector(square, small_rig());
  Detection detection(small_rig());
  detection.poses.color_from_depth[0] = RigidTransform{};
  detection.markers.color = {project(square_marker, in_front, detection.rig.color)};
  EXPECT_TRUE(detection.detect(*detector).in_rgbd[0]);
  EXPECT_TRUE(any_set(detection.masks.rgbd_color[0]));
  EXPECT_TRUE(any_set(detection.masks.rgbd_depth[0]));
  detection.frame.rgbd[0].missing = "no image";
  EXPECT_FALSE(detection.detect(*detector).in_rgbd[0]);
  EXPECT_FALSE(any_set(detection.masks.rgbd_color[0]));
  EXPECT_FALSE(any_set(detection.masks.rgbd_depth[0]));
}

TEST(MarkerOccluder, AnObjectOutOfSightIsNoFault) {
  const auto detector = make_detector(
      "{name: sign, detector: marker, marker: {id: 5, size_m: 0.1}, "
      "vertices: [[9, 0, 0], [9.1, 0, 0], [9, 0.1, 0], [9.1, 0.1, 0]]}",
      small_rig());
  Detection detection(small_rig());
  detection.poses.color_from_depth[0] = RigidTransform{};
  detection.markers.color = {project(square_marker, in_front, detection.rig.color)};
  const OccluderReport report = detection.detect(*detector);
  EXPECT_FALSE(report.in_color);
  EXPECT_EQ(report.message, "");
}

TEST(MarkerOccluder, WrongSettingsAreNamed) {
  const auto error_with = [](const std::string& settings) {
    return error_of([&] {
      make_detector("name: sign\ndetector: marker\nmarker: {id: 5, size_m: 0.1}\n" + settings,
                    small_rig());
    });
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(error_with(""), HasSubstr("expected either vertices or mesh"));
  EXPECT_THAT(error_with("vertices: [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]"),
              HasSubstr("s.yaml:4: vertices: expected points that are not all on one line"));
  EXPECT_THAT(error_with("vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]"),
              HasSubstr("vertices: expected at least 4 points"));
  EXPECT_THAT(error_with("mesh: nowhere.obj"), HasSubstr("nowhere.obj"));
  EXPECT_THAT(error_with("vertexes: []"), HasSubstr("vertexes"));
}

}  // namespace
}  // namespace diminish
