#include <gmock/gmock.h>

#include <cstring>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>

#include "core/mat.h"
#include "diminish/frame_source.h"
#include "expect_error.h"
#include "ros/camera_info.h"
#include "ros/pixel_encodings.h"
#include "setup/convert/convert.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A ROS 1 bag without chunks, as small as one can be.
class Bag {
 public:
  template <class Message>
  void add(const std::string& topic, const char* ros1_type, const Message& message,
           std::uint32_t second) {
    std::vector<std::uint8_t> bytes;
    ros::write_message(message, bytes, ros::Wire::ros1);
    add_bytes(topic, ros1_type, {bytes.begin(), bytes.end()}, second);
  }
  void add_bytes(const std::string& topic, const std::string& type, const std::string& data,
                 std::uint32_t second) {
    const auto [known, is_new] =
        connections_.emplace(topic, static_cast<std::uint32_t>(connections_.size()));
    const std::string connection = field("conn", number(known->second));
    if (is_new) record(7, connection + field("topic", topic), field("type", type));
    record(2, connection + field("time", number(second) + number(0)), data);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  static std::string number(std::uint32_t value) {
    std::string text;
    for (int i = 0; i < 4; ++i) text += static_cast<char>(value >> 8 * i);
    return text;
  }
  static std::string sized(const std::string& text) {
    return number(static_cast<std::uint32_t>(text.size())) + text;
  }
  static std::string field(const std::string& name, const std::string& value) {
    return sized(name + "=" + value);
  }
  void record(char op, const std::string& header, const std::string& data) {
    bytes_ += sized(header + field("op", std::string(1, op))) + sized(data);
  }

  std::string bytes_ = "#ROSBAG V2.0\n";
  std::map<std::string, std::uint32_t> connections_;
};

Image<Bgr> picture(int shade) {
  Image<Bgr> image(64, 48, Bgr{40, 90, static_cast<std::uint8_t>(shade)});
  return image;
}
Image<std::uint16_t> depth(int offset) {
  Image<std::uint16_t> image(32, 24);
  for (std::size_t i = 0; i < image.size(); ++i) {
    image.data()[i] = static_cast<std::uint16_t>(i % 9 == 0 ? 0 : 800 + i + offset);
  }
  return image;
}
template <class Pixel>
ros::ImageMessage stamped(const Image<Pixel>& image, double stamp_s, const std::string& frame) {
  auto message = ros::image_message(image);
  message.header = {stamp_s, frame};
  return message;
}
ros::CameraInfoMessage info(int width, int height, double focal) {
  return ros::camera_info({.width = width,
                           .height = height,
                           .fx = focal,
                           .fy = focal,
                           .cx = width / 2.,
                           .cy = height / 2.});
}

/// As RealSense's SDK writes them: its names, mono16 depth, and a unit beside it.
Bag realsense_bag() {
  Bag bag;
  const std::string device = "/device_0/sensor_";
  const float unit_m = .00025F;
  std::string unit(4, '\0');
  std::memcpy(unit.data(), &unit_m, 4);
  bag.add_bytes(device + "0/option/Depth_Units/value", "std_msgs/Float32", unit, 1);
  bag.add(device + "0/Depth_0/info/camera_info", "sensor_msgs/CameraInfo", info(32, 24, 30), 1);
  bag.add(device + "1/Color_0/info/camera_info", "sensor_msgs/CameraInfo", info(64, 48, 61), 1);
  for (int i = 0; i < 3; ++i) {
    const double stamp_s = 100 + i / 30.;
    const auto second = static_cast<std::uint32_t>(100 + i);
    const auto depth_image = depth(i);
    auto message = stamped(depth_image, stamp_s, "0");
    message.encoding = "mono16";
    bag.add(device + "0/Depth_0/image/data", "sensor_msgs/Image", message, second);
    const auto color_image = picture(50 * i);
    bag.add(device + "1/Color_0/image/data", "sensor_msgs/Image",
            stamped(color_image, stamp_s, "1"), second);
  }
  return bag;
}

TEST(ConvertBag, ARealSenseBagBecomesARecordingThatRuns) {
  const TemporaryFolder folder;
  const auto bag = folder.write("a.bag", realsense_bag().bytes());
  const auto made = folder.path() / "made";
  const Conversion conversion = convert_bag(bag, made, {});
  EXPECT_EQ(conversion.left_out, 0U);
  ASSERT_EQ(conversion.streams.size(), 3U);
  EXPECT_EQ(conversion.streams[0].from, "/device_0/sensor_1/Color_0/image/data");
  const Recording recording = load_recording(made);
  EXPECT_EQ(recording.rig.color.fx, 61);
  ASSERT_EQ(recording.rig.rgbd.size(), 1U);
  EXPECT_EQ(recording.rig.rgbd[0].depth.fx, 30);
  EXPECT_NEAR(recording.rig.rgbd[0].depth_unit_m, .00025, 1e-9);
  EXPECT_EQ(recording.rig.pose_source, "fixed");
  const auto source = open_recording(recording, {});
  int frames = 0;
  for (FrameSet frame; source->next(frame); ++frames) {
    EXPECT_THAT(frame.faults, IsEmpty());
    EXPECT_EQ(frame.rgbd[0].depth.own(), depth(frames));
    EXPECT_NEAR(frame.color.view()(5, 5).r, 50 * frames, 2);
    EXPECT_NEAR(frame.stamp_s, 100 + frames / 30., 1e-5);
  }
  EXPECT_EQ(frames, 3);
}

TEST(ConvertBag, JpegsStayAsTheyAreAndTransformsAreUsed) {
  Bag bag;
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", as_mat(picture(77)), jpeg);
  ros::TfMessage tf;
  tf.transforms.push_back({{0, "base"}, "c", {Eigen::Matrix3d::Identity(), {0, 0, 1}}});
  tf.transforms.push_back({{0, "base"}, "d", {Eigen::Matrix3d::Identity(), {.05, 0, 1}}});
  bag.add("/tf_static", "tf2_msgs/TFMessage", tf, 1);
  const auto depth_image = depth(0);
  for (std::uint32_t i = 1; i < 4; ++i) {
    const auto second = static_cast<double>(i);
    bag.add("/cam/color/image_raw/compressed", "sensor_msgs/CompressedImage",
            ros::CompressedImageMessage{{second, "c"}, "jpeg", jpeg}, i);
    bag.add("/cam/color/camera_info", "sensor_msgs/CameraInfo", info(64, 48, 61), i);
    bag.add("/cam/depth/image_raw", "sensor_msgs/Image", stamped(depth_image, second, "d"), i);
  }
  // Broken, and out of order.
  bag.add_bytes("/cam/depth/image_raw", "sensor_msgs/Image", "junk", 5);
  bag.add("/cam/depth/image_raw", "sensor_msgs/Image", stamped(depth_image, 2, "d"), 5);
  const TemporaryFolder folder;
  const auto made = folder.path() / "made";
  const Conversion conversion = convert_bag(folder.write("a.bag", bag.bytes()), made, {});
  EXPECT_EQ(conversion.left_out, 2U);
  ASSERT_EQ(conversion.problems.size(), 1U);
  EXPECT_THAT(conversion.problems[0], HasSubstr("/cam/depth/image_raw: the message ends"));
  std::ifstream file(made / "rgbd0/color/000000.jpg", std::ios::binary);
  const std::vector<char> kept((std::istreambuf_iterator<char>(file)), {});
  EXPECT_TRUE(std::equal(kept.begin(), kept.end(), jpeg.begin(), jpeg.end(),
                         [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; }));
  const Rig rig = load_rig(made / "rig.yaml");
  EXPECT_TRUE(rig.rgbd[0].color_from_depth.translation.isApprox(Eigen::Vector3d(.05, 0, 0)));
}

TEST(ConvertBag, TopicsMayBeChosen) {
  Bag bag = realsense_bag();
  const auto other = picture(9);
  bag.add("/eye/image", "sensor_msgs/Image", stamped(other, 100, "e"), 100);
  const TemporaryFolder folder;
  const auto file = folder.write("a.bag", bag.bytes());
  BagChoice choice;
  choice.color = "/eye/image";
  choice.rgbd = {
      {"kinect", "/device_0/sensor_1/Color_0/image/data", "/device_0/sensor_0/Depth_0/image/data"}};
  const auto made = folder.path() / "made";
  convert_bag(file, made, choice);
  const Rig rig = load_rig(made / "rig.yaml");
  EXPECT_EQ(rig.rgbd[0].name, "kinect");
  EXPECT_EQ(rig.pose_source, "marker");
  choice.color = "/nothing";
  EXPECT_THAT(error_of([&] { convert_bag(file, folder.path() / "b", choice); }),
              HasSubstr("a.bag: /nothing: expected a topic of colour images, the bag has "));
  EXPECT_THAT(error_of([&] { convert_bag(file, made, {}); }),
              HasSubstr("expected an empty folder"));
  EXPECT_THAT(error_of([&] {
                convert_bag(folder.write("empty.bag", Bag().bytes()), folder.path() / "c", {});
              }),
              HasSubstr("expected topics of colour and of depth images, got no images"));
  Bag without_images;
  for (const char* topic : {"/b", "/a", "/c", "/d", "/e", "/f", "/g"}) {
    without_images.add_bytes(topic, "std_msgs/String", std::string(4, '\0'), 1);
  }
  EXPECT_THAT(
      error_of([&] {
        convert_bag(folder.write("words.bag", without_images.bytes()), folder.path() / "d", {});
      }),
      HasSubstr(
          "got no images, but /a (std_msgs/msg/String), /b (std_msgs/msg/String), /c "
          "(std_msgs/msg/String), /d (std_msgs/msg/String), /e (std_msgs/msg/String), 2 more"));
}

}  // namespace
}  // namespace diminish
