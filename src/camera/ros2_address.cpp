#include "camera/ros2_address.h"

#include <cctype>

#include "core/text.h"

namespace diminish {
namespace {

using Kind = Ros2Address::Kind;

/// What stands before the last slash.
std::string folder_of(const std::string& topic) {
  return topic.substr(0, topic.rfind('/'));
}

/// An image's topic, with what its name says. info: empty for the camera_info beside it.
Ros2Address::Stream stream(const CameraUri& uri, const char* key, const char* info_key) {
  Ros2Address::Stream stream;
  stream.topic = ros2_topic(uri, uri.target, uri.text_of(key, ""));
  std::string image = stream.topic;
  if (image.ends_with("/compressed")) stream.kind = Kind::compressed;
  if (image.ends_with("/compressedDepth")) stream.kind = Kind::compressed_depth;
  if (stream.kind != Kind::image) image = folder_of(image);
  stream.is_rectified = image.substr(image.rfind('/') + 1).starts_with("image_rect");
  stream.info = uri.has(info_key) ? ros2_topic(uri, uri.target, uri.text_of(info_key, ""))
                                  : folder_of(image) + "/camera_info";
  return stream;
}

}  // namespace

bool is_ros2_topic(const std::string& name) {
  if (!name.starts_with('/') || name.ends_with('/') || name.find("//") != std::string::npos ||
      name.size() > 200) {
    return false;
  }
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool is_letter = std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
    const bool is_digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
    if (c != '/' && !is_letter && !(is_digit && name[i - 1] != '/')) return false;
  }
  return true;
}

std::string ros2_topic(const CameraUri& uri, const std::string& base, const std::string& name) {
  std::string topic = name.starts_with('/') ? name : base + "/" + name;
  if (!topic.starts_with('/')) topic = "/" + topic;
  if (name.empty() || !is_ros2_topic(topic)) {
    uri.fail("expected a topic such as /camera/color/image_raw, got '" + printable(topic) + "'");
  }
  return topic;
}

dds::Network parse_ros2_network(const CameraUri& uri) {
  dds::Network network;
  network.domain =
      uri.has("domain") ? static_cast<int>(uri.number("domain", 0, 0, 232)) : dds::default_domain();
  network.interface = uri.text_of("interface", "");
  const std::string transport = uri.text_of("transport", "shm");
  if (transport != "shm" && transport != "udp") {
    uri.fail("transport: expected shm (UDP, and shared memory on this machine) or udp, got '" +
             printable(transport) + "'");
  }
  network.shared_memory = transport == "shm";
  network.keys = uri.text_of("keys", "");
  if (uri.has("keys") && network.keys.empty()) {
    uri.fail("keys: expected a folder that `diminish keys` made");
  }
  if (uri.has("mbits")) network.most_mbits = uri.number("mbits", 0, 1, 100'000);
  return network;
}

Ros2Address::Clock parse_ros2_clock(const CameraUri& uri) {
  const std::string clock = uri.text_of("clock", "auto");
  if (clock == "auto") return Ros2Address::Clock::automatic;
  if (clock == "synchronized") return Ros2Address::Clock::synchronized;
  if (clock == "arrival") return Ros2Address::Clock::arrival;
  uri.fail("clock: expected auto, synchronized or arrival, got '" + printable(clock) + "'");
}

Ros2Address parse_ros2_address(const CameraUri& uri) {
  uri.expect_parameters({"color", "depth", "info", "depth_info", "rgbd", "tf", "clock", "domain",
                         "interface", "transport", "reliable", "keys"});
  Ros2Address address;
  address.network = parse_ros2_network(uri);
  if (uri.has("color")) address.color = stream(uri, "color", "info");
  if (uri.has("depth")) {
    address.depth = stream(uri, "depth", uri.has("color") ? "depth_info" : "info");
    // As RealSense's driver and others name it.
    address.is_aligned = address.depth->topic.find("aligned_depth_to_") != std::string::npos;
  }
  if (address.color && address.color->kind == Kind::compressed_depth) {
    uri.fail("color: expected a colour image's topic, got " + address.color->topic);
  }
  if (address.depth && address.depth->kind == Kind::compressed) {
    uri.fail("depth: expected an image that is not compressed, or compressedDepth, got " +
             address.depth->topic);
  }
  if (!address.color && !address.depth) {
    address.rgbd = ros2_topic(uri, uri.target, uri.text_of("rgbd", "rgbd"));
  } else if (uri.has("rgbd")) {
    uri.fail("expected rgbd, or color and depth");
  }
  address.uses_tf = uri.has("tf");
  address.is_reliable = uri.has("reliable");
  address.clock = parse_ros2_clock(uri);
  return address;
}

}  // namespace diminish
