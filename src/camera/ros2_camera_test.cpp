#include <gmock/gmock.h>

#include <cmath>

#include "camera/sender_clock.h"
#include "dds/dds.h"
#include "diminish/camera_source.h"
#include "expect_error.h"
#include "ros/camera_info.h"
#include "ros/compressed_depth.h"
#include "ros/pixel_encodings.h"
#include "ros2_domain.h"

namespace diminish {
namespace {

using dds::Delivery;
using std::chrono::milliseconds;
using ::testing::HasSubstr;

/// Sends messages until the test has seen what it waits for.
class Ros2Camera : public ::testing::Test {
 protected:
  template <class Message>
  dds::Publication& publish(const std::string& topic, Delivery delivery = Delivery::newest) {
    topics_.push_back(
        std::make_unique<dds::Publication>(node_, dds::Topic{topic, Message::dds_type}, delivery));
    return *topics_.back();
  }
  template <class Message>
  static void send(dds::Publication& to, Message message, [[maybe_unused]] double stamp_s) {
    if constexpr (requires { message.header; }) message.header.stamp_s = stamp_s;
    std::vector<std::uint8_t> bytes;
    ros::write_message(message, bytes);
    to.send(bytes);
  }
  static double utc_s() { return monotonic_now_s() + utc_from_monotonic_s(); }

  /// Calls `send` again and again until an image of the sensor arrives.
  template <class Send>
  static CameraImage image_of(CameraSource& camera, Sensor sensor, Send send) {
    CameraImage image;
    for (const double end_s = monotonic_now_s() + 20; monotonic_now_s() < end_s;) {
      send();
      for (int i = 0; i < 4; ++i) {
        if (camera.read(image, milliseconds(10)) == CameraSource::Status::image &&
            image.sensor == sensor) {
          return image;
        }
      }
    }
    ADD_FAILURE() << "no image";
    return image;
  }

  static Image<Bgr> picture() {
    Image<Bgr> image(40, 30);
    for (std::size_t i = 0; i < image.size(); ++i) {
      const auto value = static_cast<std::uint8_t>(i % 200);
      image.data()[i] = {value, static_cast<std::uint8_t>(value + 1), 7};
    }
    return image;
  }
  static Image<std::uint16_t> depth() {
    Image<std::uint16_t> image(20, 15);
    for (std::size_t i = 0; i < image.size(); ++i) {
      image.data()[i] = static_cast<std::uint16_t>(i % 5 == 0 ? 0 : 700 + 3 * i);
    }
    return image;
  }
  static ros::CameraInfoMessage info(int width, int height) {
    return ros::camera_info(
        {.width = width, .height = height, .fx = 33, .fy = 34, .cx = 20, .cy = 15});
  }

  Ros2Domain domain_;
  std::shared_ptr<dds::Node> node_ = dds::Node::open({.domain = domain_.number()});
  std::vector<std::unique_ptr<dds::Publication>> topics_;
};

TEST_F(Ros2Camera, DeliversWhatADriverSends) {
  auto& color = publish<ros::ImageMessage>("/a/color/image_raw");
  auto& depth_topic = publish<ros::ImageMessage>("/a/depth/image_raw");
  Rig rig;
  rig.rgbd.push_back({.name = "rgbd0", .depth_unit_m = .001});
  const auto camera =
      open_camera("ros2:/a?color=color/image_raw&depth=depth/image_raw", {"rgbd0", &rig, 0});
  const auto sent = picture();
  double stamp_s = 0;
  const CameraImage got = image_of(
      *camera, Sensor::color, [&] { send(color, ros::image_message(sent), stamp_s = utc_s()); });
  EXPECT_EQ(got.color, sent);
  EXPECT_EQ(got.fault, "");
  EXPECT_NEAR(got.stamp_s, monotonic_now_s(), 5);
  EXPECT_LE(got.stamp_s, monotonic_now_s());
  ASSERT_TRUE(camera->clock());
  EXPECT_LE(std::abs(camera->clock()->offset_s), 5);

  const auto sent_depth = depth();
  EXPECT_EQ(image_of(*camera, Sensor::depth,
                     [&] { send(depth_topic, ros::image_message(sent_depth), utc_s()); })
                .depth,
            sent_depth);
}

TEST_F(Ros2Camera, DeliversWhatIsCompressed) {
  auto& depth_topic = publish<ros::CompressedImageMessage>("/b/depth/image_raw/compressedDepth");
  const auto camera =
      open_camera("ros2:/b?depth=depth/image_raw/compressedDepth", {"d", nullptr, 0});
  const auto sent = depth();
  std::vector<std::uint8_t> bytes;
  ros::CompressedImageMessage message;
  message.format = ros::write_compressed_depth(sent, bytes);
  message.data = bytes;
  // It waits for a camera_info, in vain.
  EXPECT_EQ(image_of(*camera, Sensor::depth, [&] { send(depth_topic, message, utc_s()); }).depth,
            sent);
  EXPECT_FALSE(camera->intrinsics(Sensor::depth));
}

TEST_F(Ros2Camera, KnowsWhatTheDriverTellsOfItsLenses) {
  auto& color = publish<ros::ImageMessage>("/c/color/image_raw");
  auto& depth_topic = publish<ros::ImageMessage>("/c/depth/image_raw");
  auto& color_info = publish<ros::CameraInfoMessage>("/c/color/camera_info");
  auto& depth_info = publish<ros::CameraInfoMessage>("/c/depth/camera_info");
  auto& tf = publish<ros::TfMessage>("/tf_static", Delivery::kept);
  send(tf,
       ros::TfMessage{{{{0, "link"}, "c", {}},
                       {{0, "link"}, "d", {Eigen::Matrix3d::Identity(), {.05, 0, 0}}}}},
       0);
  const auto camera =
      open_camera("ros2:/c?color=color/image_raw&depth=depth/image_raw&tf", {"rgbd0", nullptr, 0});
  const auto pixels = picture();
  const auto depth_pixels = depth();
  const auto send_all = [&] {
    send(color_info, info(40, 30), utc_s());
    send(depth_info, info(20, 15), utc_s());
    auto message = ros::image_message(pixels);
    message.header.frame_id = "c";
    send(color, message, utc_s());
    message = ros::image_message(depth_pixels);
    message.header.frame_id = "d";
    send(depth_topic, message, utc_s());
  };
  image_of(*camera, Sensor::color, send_all);
  image_of(*camera, Sensor::depth, send_all);
  ASSERT_TRUE(camera->intrinsics(Sensor::color));
  EXPECT_EQ(camera->intrinsics(Sensor::color)->fx, 33);
  EXPECT_EQ(camera->intrinsics(Sensor::color)->width, 40);
  ASSERT_TRUE(camera->intrinsics(Sensor::depth));
  EXPECT_EQ(camera->intrinsics(Sensor::depth)->width, 20);
  CameraImage image;  // a transform is no image, but read with them
  for (int i = 0; i < 200 && !camera->color_from_depth(); ++i) {
    camera->read(image, milliseconds(100));
  }
  ASSERT_TRUE(camera->color_from_depth());
  EXPECT_NEAR(camera->color_from_depth()->translation.x(), .05, 1e-12);
}

TEST_F(Ros2Camera, ANodesMomentIsTwoImages) {
  auto& topic = publish<ros::RgbdMessage>("/d/rgbd");
  Rig rig;
  rig.rgbd.push_back({.name = "rgbd0", .depth_unit_m = .0005});
  const auto camera = open_camera("ros2:/d?rgbd=rgbd", {"rgbd0", &rig, 0});
  const auto sent = depth();
  std::vector<std::uint8_t> depth_bytes, png;
  ros::RgbdMessage message;
  message.depth.format = ros::write_compressed_depth(sent, depth_bytes);
  message.depth.data = depth_bytes;
  message.depth_unit_m = .00025;
  const auto depth_only = [&] {
    message.depth.header.stamp_s = utc_s();
    send(topic, message, 0);
  };
  const CameraImage got = image_of(*camera, Sensor::depth, depth_only);
  ASSERT_EQ(got.depth.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_NEAR(got.depth.data()[i], sent.data()[i] / 2., .51);
  }
}

TEST_F(Ros2Camera, ANodeOfThisMachineSendsItsImagesAsTheyAre) {
  auto& color = publish<ros::ImageMessage>("/h/color/image_raw");
  auto& depth_topic = publish<ros::ImageMessage>("/h/depth/image_raw");
  Rig rig;
  rig.rgbd.push_back({.name = "rgbd0", .depth_unit_m = .00025});
  const auto camera = open_camera("ros2:/h", {"rgbd0", &rig, 0});
  const auto pixels = picture();
  const CameraImage got =
      image_of(*camera, Sensor::color, [&] { send(color, ros::image_message(pixels), utc_s()); });
  EXPECT_EQ(got.color, pixels);
  // Steps of a quarter of a millimetre, in metres.
  const auto sent = depth();
  const Image<float> metres = ros::depth_in_metres(sent, .00025);
  EXPECT_FLOAT_EQ(metres(1, 0), 703 * .00025F);
  const auto send_depth = [&] { send(depth_topic, ros::image_message(metres), utc_s()); };
  EXPECT_EQ(image_of(*camera, Sensor::depth, send_depth).depth, sent);
}

TEST_F(Ros2Camera, AnotherMachinesClockIsFollowed) {
  auto& color = publish<ros::ImageMessage>("/e/color/image_raw");
  const auto camera = open_camera("ros2:/e?color=color/image_raw", {"color", nullptr, 0});
  const auto pixels = picture();
  const CameraImage got = image_of(
      *camera, Sensor::color, [&] { send(color, ros::image_message(pixels), utc_s() + 1000); });
  EXPECT_NEAR(got.stamp_s, monotonic_now_s(), 5);
  EXPECT_LE(got.stamp_s, monotonic_now_s());
  EXPECT_NEAR(camera->clock()->offset_s, 1000, 5);
  EXPECT_FALSE(camera->clock()->is_trusted);
}

TEST_F(Ros2Camera, ABrokenMessageIsADamagedImageThatNamesItsTopic) {
  auto& color = publish<ros::ImageMessage>("/f/color/image_raw");
  Rig rig;
  const auto camera = open_camera("ros2:/f?color=color/image_raw", {"color", &rig, 0});
  const auto pixels = picture();
  auto message = ros::image_message(pixels);
  message.data = message.data.first(100);
  EXPECT_THAT(image_of(*camera, Sensor::color, [&] { send(color, message, utc_s()); }).fault,
              HasSubstr("/f/color/image_raw: expected 3600 bytes of bgr8 for 40x30"));
  std::vector<std::uint8_t> junk(50, 9);
  EXPECT_THAT(image_of(*camera, Sensor::color, [&] { color.send(junk); }).fault,
              HasSubstr("plain CDR"));
  // And the next good one is taken.
  CameraImage good;
  for (int i = 0; i < 100 && good.color.empty(); ++i) {
    good =
        image_of(*camera, Sensor::color, [&] { send(color, ros::image_message(pixels), utc_s()); });
  }
  EXPECT_EQ(good.color, pixels);
}

TEST_F(Ros2Camera, TheUsersViewNeedsColour) {
  EXPECT_THAT(error_of([] {
                open_camera("ros2:/g?depth=depth/image_raw", {"color", nullptr, 0});
              }),
              HasSubstr("expected color=TOPIC"));
  EXPECT_THAT(error_of([] {
                open_camera("ros2:/g?interface=203.0.113.9&color=a", {"color", nullptr, 0});
              }),
              HasSubstr("expected an address of this machine, one of 127.0.0.1"));
}

}  // namespace
}  // namespace diminish
