#pragma once

#include "camera/ros2_address.h"
#include "dds/dds.h"

namespace diminish {

/// The parameters of a node's topics: of `--topic`, and those that a node: camera has beside its
/// own.
inline constexpr const char* node_network_parameters[] = {"domain",   "interface", "transport",
                                                          "reliable", "keys",      "mbits"};

/// The network that these name, at both ends. Throws Error.
inline dds::Network node_network(const CameraUri& uri) {
  dds::Network network = parse_ros2_network(uri);
  network.in_packets = uri.has("reliable") && !network.interface.empty();
  return network;
}

}  // namespace diminish
