#include "camera/ros2_devices.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <string>
#include <thread>

#include "camera/ros2_address.h"
#include "ros/messages.h"

namespace diminish {
namespace {

/// A program says each second that it is there.
constexpr std::chrono::milliseconds listening(1500);

bool has_word(const std::string& topic, const char* word) {
  return topic.find(word) != std::string::npos;
}

std::size_t shared(const std::string& a, const std::string& b) {
  const auto [end, ignored] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  return static_cast<std::size_t>(end - a.begin());
}

}  // namespace

std::vector<CameraDevice> ros2_devices(const std::vector<dds::Topic>& topics) {
  std::vector<CameraDevice> devices;
  std::vector<std::string> colors, depths;
  std::set<std::string> nodes;
  for (const dds::Topic& topic : topics) {
    if (!is_ros2_topic(topic.name)) continue;
    if (topic.type == ros::RgbdMessage::dds_type && topic.name.ends_with("/rgbd")) {
      const std::string base = topic.name.substr(0, topic.name.size() - 5);
      devices.push_back({"ros2:" + base, "a diminish camera-node"});
      nodes.insert(base + "/");
    }
  }
  for (const dds::Topic& topic : topics) {
    const bool is_image = topic.type == ros::ImageMessage::dds_type ||
                          topic.type == ros::CompressedImageMessage::dds_type;
    const bool is_of_node = std::any_of(nodes.begin(), nodes.end(), [&](const std::string& base) {
      return topic.name.starts_with(base);
    });
    if (!is_image || is_of_node || !is_ros2_topic(topic.name)) continue;
    (has_word(topic.name, "depth") ? depths : colors).push_back(topic.name);
  }
  std::set<std::string> with_depth;
  for (const std::string& depth : depths) {
    const auto best = std::max_element(colors.begin(), colors.end(),
                                       [&](const std::string& a, const std::string& b) {
                                         return shared(a, depth) < shared(b, depth);
                                       });
    if (best != colors.end()) with_depth.insert(*best);
    const std::string color = best == colors.end() ? "" : "color=" + *best + "&";
    devices.push_back({"ros2:?" + color + "depth=" + depth, "ROS 2 topics"});
  }
  for (const std::string& color : colors) {
    if (with_depth.contains(color)) continue;
    devices.push_back({"ros2:?color=" + color, "a ROS 2 topic"});
  }
  return devices;
}

std::vector<CameraDevice> list_ros2_devices() {
  const auto node = dds::Node::open({.domain = dds::default_domain()});
  std::this_thread::sleep_for(listening);
  return ros2_devices(node->topics_of_others());
}

}  // namespace diminish
