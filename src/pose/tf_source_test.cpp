// Transforms of a robot, sent as ROS 2 sends them.

#include <gmock/gmock.h>

#include <thread>

#include "analytic_scene.h"
#include "camera/sender_clock.h"
#include "dds/dds.h"
#include "diminish/camera_source.h"
#include "diminish/pose_source.h"
#include "expect_error.h"
#include "pose/camera_poses.h"
#include "ros/messages.h"
#include "ros2_domain.h"

namespace diminish {
namespace {

using dds::Delivery;
using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The colour camera is held by a robot that drives straight ahead and turns evenly; the RGB-D
/// camera stands on its base.
class TfSource : public ::testing::Test {
 protected:
  TfSource()
      : frame_({.has_box = false}, {{-0.45, 0.3, 0.9}}),
        node_(dds::Node::open({.domain = domain_.number()})),
        tf_(node_, {"/tf", ros::TfMessage::dds_type}, Delivery::reliable),
        tf_static_(node_, {"/tf_static", ros::TfMessage::dds_type}, Delivery::kept) {
    frame_.frame.rgbd[0].depth_stamp_s = frame_.frame.stamp_s = start_s_;
  }

  static RigidTransform map_from_base(double time_s) {
    return {Eigen::AngleAxisd(.4 * time_s, Eigen::Vector3d::UnitY()).toRotationMatrix(),
            {.3 * time_s, 0, -.1 * time_s}};
  }
  RigidTransform base_from_eye() const { return {Eigen::Matrix3d::Identity(), {0, -.4, .1}}; }

  static void send(dds::Publication& to, std::vector<ros::TransformStamped> transforms) {
    std::vector<std::uint8_t> bytes;
    ros::write_message(ros::TfMessage{std::move(transforms)}, bytes);
    to.send(bytes);
  }
  static ros::TransformStamped edge(const std::string& parent, const std::string& child,
                                    const RigidTransform& parent_from_child, double time_s) {
    return {{time_s + utc_from_monotonic_s(), parent}, child, parent_from_child};
  }
  /// Where the robot is at `start_s_` and these times after it.
  void send_robot(const std::vector<double>& times_s) {
    std::vector<ros::TransformStamped> transforms;
    for (const double after_s : times_s) {
      transforms.push_back(edge("map", "base", map_from_base(after_s), start_s_ + after_s));
    }
    send(tf_, transforms);
  }
  void send_statics() {
    send(tf_static_, {edge("base", "eye", base_from_eye(), 0),
                      edge("map", "kinect_depth", frame_.poses.depth_from_world[0]->inverse(), 0)});
  }

  std::unique_ptr<CameraPoses> make(const std::string& more = "") {
    frame_.rig.pose_source = "tf";
    frame_.rig.pose = Config::parse(
        "{source: tf, world: map, frames: {color: eye, rgbd0: "
        "kinect_depth}" +
            more + "}",
        "rig.yaml");
    return std::make_unique<CameraPoses>(frame_.rig, scene_);
  }
  Poses poses_at(CameraPoses& source, double after_s) {
    frame_.frame.stamp_s = start_s_ + after_s;
    Poses poses;
    source.estimate(frame_.frame, {{}, {{}}}, poses);
    return poses;
  }
  /// Sends transforms until the source hears them: those who listen must be found first.
  void meet(CameraPoses& source) {
    for (int i = 0; i < 400; ++i) {
      send_robot({0, .1});
      const Poses poses = poses_at(source, .05);
      if (poses.color_from_world && poses.depth_from_world[0]) return;
      std::this_thread::sleep_for(milliseconds(50));
    }
    ADD_FAILURE() << "nothing is heard";
  }

  Ros2Domain domain_;
  testing::AnalyticFrame frame_;
  Scene scene_;
  double start_s_ = monotonic_now_s();
  std::shared_ptr<dds::Node> node_;
  dds::Publication tf_, tf_static_;
};

TEST_F(TfSource, PosesAreThoseOfTheImagesOwnTimes) {
  send_statics();
  const auto source = make(", from: \"ros2:?clock=synchronized\", wait_s: 5");
  EXPECT_FALSE(source->needs_markers());
  meet(*source);
  send_robot({.2, .3, .4, .5, .6, .7, .8, .9, 1});
  for (const double after_s : {.15, .432, .9}) {
    const Poses poses = poses_at(*source, after_s);
    EXPECT_THAT(poses.messages, IsEmpty());
    ASSERT_TRUE(poses.color_from_world && poses.color_from_depth[0]);
    const RigidTransform expected = (map_from_base(after_s) * base_from_eye()).inverse();
    // Stamps have the resolution of a double that counts from 1970.
    EXPECT_LT((poses.color_from_world->translation - expected.translation).norm(), 1e-6);
    EXPECT_LT(rotation_difference_deg(poses.color_from_world->rotation, expected.rotation), 1e-4);
    EXPECT_LT(
        (*poses.color_from_depth[0] * Eigen::Vector3d(.1, .2, 1) -
         expected * (frame_.poses.depth_from_world[0]->inverse() * Eigen::Vector3d(.1, .2, 1)))
            .norm(),
        1e-6);
  }
}

TEST_F(TfSource, ATransformThatIsOnItsWayIsAwaited) {
  send_statics();
  const auto source = make(", from: \"ros2:?clock=synchronized\", wait_s: 20");
  meet(*source);
  std::thread late([this] {
    std::this_thread::sleep_for(milliseconds(200));
    send_robot({.4});
  });
  const Poses poses = poses_at(*source, .3);
  late.join();
  ASSERT_TRUE(poses.color_from_world);
  EXPECT_LT((poses.color_from_world->inverse().translation -
             (map_from_base(.3) * base_from_eye()).translation)
                .norm(),
            1e-6);
}

TEST_F(TfSource, LostTransformsAreSaid) {
  send_statics();
  const auto source = make(", from: \"ros2:?clock=synchronized\", wait_s: 0.01, gap_s: 0.2");
  meet(*source);
  Poses poses = poses_at(*source, .15);
  EXPECT_FALSE(poses.color_from_world);
  EXPECT_TRUE(poses.depth_from_world[0]);  // it stands
  EXPECT_THAT(poses.messages, ElementsAre("no pose of color: the newest transform of base is 0.05 "
                                          "s older than the image"));
  poses = poses_at(*source, -1);
  EXPECT_THAT(poses.messages,
              ElementsAre("no pose of color: no transforms of base within 0.2 s around the image"));
  tf_.send({9, 9, 9, 9, 9});
  bool is_told = false;
  for (int i = 0; i < 200 && !is_told; ++i) {
    std::this_thread::sleep_for(milliseconds(20));
    for (const std::string& message : poses_at(*source, .05).messages) {
      is_told |= message.starts_with("/tf: expected a message in plain CDR");
    }
  }
  EXPECT_TRUE(is_told);
}

TEST_F(TfSource, FramesThatAreNotConnectedAreNamed) {
  const auto source = make();
  const Poses poses = poses_at(*source, 0);
  EXPECT_THAT(poses.messages,
              ElementsAre("no pose of color: /tf does not connect eye and map",
                          "no pose of rgbd0: /tf does not connect kinect_depth and map"));
}

TEST_F(TfSource, AnotherMachinesClockIsFollowed) {
  const auto source = make(", from: \"ros2:?clock=arrival\", wait_s: 0.01, gap_s: 5");
  send_statics();
  // A robot whose clock is an hour ahead, and that stands still.
  bool is_known = false;
  for (int i = 0; i < 400 && !is_known; ++i) {
    const double now_s = monotonic_now_s();
    send(tf_, {edge("map", "base", map_from_base(1), now_s + 3600)});
    std::this_thread::sleep_for(milliseconds(50));
    const Poses poses = poses_at(*source, now_s - .02 - start_s_);
    is_known = poses.color_from_world.has_value();
  }
  EXPECT_TRUE(is_known);
}

TEST_F(TfSource, WrongSettingsAreNamed) {
  EXPECT_THAT(error_of([&] { make(", gap_s: -1"); }),
              HasSubstr("rig.yaml:1: gap_s: expected a number above 0"));
  EXPECT_THAT(error_of([&] { make(", frame: x"); }),
              HasSubstr("frame: unknown key, expected one of source, world"));
  EXPECT_THAT(error_of([&] { make(", from: \"v4l2:/dev/video0\""); }),
              HasSubstr("rig.yaml:1: from: v4l2:/dev/video0: expected ros2:, with parameters"));
  EXPECT_THAT(error_of([&] { make(", from: \"ros2:?clock=sun\""); }),
              HasSubstr("rig.yaml:1: from: ros2:?clock=sun: clock: expected auto"));
  EXPECT_THAT(error_of([&] { make(", from: \"ros2:?keys=/nowhere\""); }),
              HasSubstr("/nowhere/identity_ca.cert.pem: cannot be read"));
  frame_.rig.rgbd[0].name = "other";
  EXPECT_THAT(error_of([&] { make(); }), HasSubstr("other"));
}

}  // namespace
}  // namespace diminish
