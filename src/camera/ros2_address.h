#pragma once

#include <optional>
#include <string>

#include "dds/dds.h"
#include "diminish/camera_source.h"

namespace diminish {

/// What a ros2: URI names.
struct Ros2Address {
  enum class Kind { image, compressed, compressed_depth };
  struct Stream {
    std::string topic, info;  ///< ROS's names: "/camera/color/image_raw", ".../camera_info"
    Kind kind = Kind::image;
    bool is_rectified = false;
  };
  /// How images' stamps are understood. `automatic`: trusted if the first image seems to be at most
  /// 0.2 s old.
  enum class Clock { automatic, synchronized, arrival };

  std::optional<Stream> color, depth;
  std::string rgbd;  ///< both in one message, of `diminish camera-node`; empty: none
  /// The driver draws depth into the colour sensor's view.
  bool is_aligned = false;
  bool uses_tf = false;
  /// Images that were lost on the way are sent again; the sender must do so, too.
  bool is_reliable = false;
  Clock clock = Clock::automatic;
  dds::Network network;
};

/// Throws Error that names the URI and what was expected.
Ros2Address parse_ros2_address(const CameraUri& uri);

/// The network that a URI's parameters domain, interface, transport, keys and mbits name. Throws
/// Error.
dds::Network parse_ros2_network(const CameraUri& uri);

/// Its parameter clock. Throws Error.
Ros2Address::Clock parse_ros2_clock(const CameraUri& uri);

/// Whether a whole name is one of a topic by ROS's rules.
bool is_ros2_topic(const std::string& name);

/// A topic by ROS's rules: "/camera/color"; a relative one is below `base`. Throws Error.
std::string ros2_topic(const CameraUri& uri, const std::string& base, const std::string& name);

}  // namespace diminish
