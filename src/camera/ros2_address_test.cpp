#include "camera/ros2_address.h"

#include <gmock/gmock.h>

#include "expect_error.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;
using Kind = Ros2Address::Kind;

Ros2Address parse(const std::string& text) {
  return parse_ros2_address(parse_camera_uri("ros2:" + text));
}

TEST(Ros2Address, TopicsAreBelowTheTarget) {
  const auto address = parse("/camera?color=color/image_raw&depth=/other/depth/image_rect_raw");
  ASSERT_TRUE(address.color && address.depth);
  EXPECT_EQ(address.color->topic, "/camera/color/image_raw");
  EXPECT_EQ(address.color->info, "/camera/color/camera_info");
  EXPECT_EQ(address.depth->topic, "/other/depth/image_rect_raw");
  EXPECT_EQ(address.depth->info, "/other/depth/camera_info");
  EXPECT_FALSE(address.color->is_rectified);
  EXPECT_TRUE(address.depth->is_rectified);
  EXPECT_FALSE(address.is_aligned);
  EXPECT_TRUE(address.rgbd.empty());
  EXPECT_EQ(dds::wire_name(address.color->topic), "rt/camera/color/image_raw");
}

TEST(Ros2Address, NamesTellHowImagesAreCompressed) {
  const auto address = parse(
      "/c?color=color/image_raw/compressed&depth=aligned_depth_to_color/image_raw/compressedDepth");
  EXPECT_EQ(address.color->kind, Kind::compressed);
  EXPECT_EQ(address.color->info, "/c/color/camera_info");
  EXPECT_EQ(address.depth->kind, Kind::compressed_depth);
  EXPECT_EQ(address.depth->info, "/c/aligned_depth_to_color/camera_info");
  EXPECT_TRUE(address.is_aligned);
}

TEST(Ros2Address, WithoutTopicsItIsACameraNode) {
  EXPECT_EQ(parse("/rgbd0").rgbd, "/rgbd0/rgbd");
  EXPECT_EQ(parse("rgbd0?rgbd=moments").rgbd, "/rgbd0/moments");
}

TEST(Ros2Address, OtherMachinesAreReachedOnlyIfAnInterfaceIsNamed) {
  EXPECT_EQ(parse("/c").network.interface, "");
  const auto network = parse("/c?interface=10.0.0.7&domain=42&transport=udp").network;
  EXPECT_EQ(network.interface, "10.0.0.7");
  EXPECT_EQ(network.domain, 42);
  EXPECT_FALSE(network.shared_memory);
  EXPECT_EQ(network.most_mbits, 0);
  EXPECT_EQ(parse_ros2_network(parse_camera_uri("ros2:/c?mbits=90")).most_mbits, 90);
  setenv("ROS_DOMAIN_ID", "17", 1);
  EXPECT_EQ(parse("/c").network.domain, 17);
  setenv("ROS_DOMAIN_ID", "many", 1);
  EXPECT_THAT(error_of([] { parse("/c"); }), HasSubstr("ROS_DOMAIN_ID: expected a whole number"));
  unsetenv("ROS_DOMAIN_ID");
}

TEST(Ros2Address, ComplaintsNameTheUriAndWhatWasExpected) {
  for (const auto& [text, what] : {
           std::pair{"/c d", "expected a topic such as /camera/color/image_raw, got '/c d/rgbd'"},
           {"/c?colour=x", "unknown parameter 'colour'"},
           {"/c?color=a//b", "got '/c/a//b'"},
           {"/c?color=3d", "got '/c/3d'"},
           {"/c?color=a%20b", "expected a topic"},
           {"/c?color=a/compressedDepth", "color: expected a colour image's topic"},
           {"/c?depth=a/compressed", "depth: expected an image that is not compressed"},
           {"/c?color=a&rgbd=b", "expected rgbd, or color and depth"},
           {"/c?clock=ntp", "clock: expected auto, synchronized or arrival, got 'ntp'"},
           {"/c?domain=233", "domain: expected a number from 0 to 232"},
           {"/c?transport=tcp", "transport: expected shm"},
       }) {
    const std::string message = error_of([&] { parse(text); });
    EXPECT_THAT(message, HasSubstr("ros2:" + std::string(text)));
    EXPECT_THAT(message, HasSubstr(what));
  }
}

}  // namespace
}  // namespace diminish
