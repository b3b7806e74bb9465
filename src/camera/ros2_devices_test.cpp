#include "camera/ros2_devices.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "ros/messages.h"
#include "ros2_domain.h"

namespace diminish {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> uris(const std::vector<CameraDevice>& devices) {
  std::vector<std::string> texts;
  for (const CameraDevice& device : devices) texts.push_back(device.uri);
  return texts;
}

TEST(Ros2Devices, TopicsBecomeCameras) {
  const std::string image = ros::ImageMessage::dds_type;
  const std::string compressed = ros::CompressedImageMessage::dds_type;
  EXPECT_THAT(uris(ros2_devices({{"/a/color/image_raw", image},
                                 {"/a/depth/image_raw", image},
                                 {"/b/color/image_raw", image},
                                 {"/b/depth/image_raw/compressedDepth", compressed},
                                 {"/chatter", "std_msgs::msg::dds_::String_"},
                                 {"/eye/image_raw/compressed", compressed},
                                 {"/node/color/image_raw", image},
                                 {"/node/rgbd", ros::RgbdMessage::dds_type},
                                 {"/\x1b[31mred", image}})),
              ElementsAre("ros2:/node", "ros2:?color=/a/color/image_raw&depth=/a/depth/image_raw",
                          "ros2:?color=/b/color/image_raw&depth=/b/depth/image_raw/compressedDepth",
                          "ros2:?color=/eye/image_raw/compressed"));
  EXPECT_EQ(parse_camera_uri("ros2:?color=/eye/image_raw/compressed").target, "");
}

TEST(Ros2Devices, WhatIsOnTheAirIsFoundUntilItEnds) {
  const Ros2Domain domain;
  const auto others = [&](bool is_there) {
    const auto node = dds::Node::open({.domain = domain.number(), .shared_memory = false});
    for (int i = 0; i < 300; ++i) {
      const auto topics = node->topics_of_others();
      const bool is_found = std::any_of(topics.begin(), topics.end(), [](const dds::Topic& topic) {
        return topic.name == "/camera/image_raw";
      });
      if (is_found == is_there) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  };
  const auto observer = dds::Node::open({.domain = domain.number(), .shared_memory = false});
  {
    const dds::Publication publication(dds::Node::open({.domain = domain.number()}),
                                       {"/camera/image_raw", ros::ImageMessage::dds_type},
                                       dds::Delivery::newest);
    EXPECT_TRUE(others(true));
  }
  EXPECT_TRUE(others(false));
}

}  // namespace
}  // namespace diminish
