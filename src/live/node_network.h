#pragma once

#include "camera/ros2_address.h"
#include "dds/dds.h"

namespace diminish {

/// The parameters of a node's topics: of `--topic`, and those that a node: camera has beside its
/// own.
inline constexpr const char* node_network_parameters[] = {"domain", "interface", "transport",
                                                          "keys", "mbits"};

/// How a node's messages travel, at both ends.
struct NodeWire {
  dds::Network network;
  dds::Delivery delivery = dds::Delivery::newest;
};

/// Between machines packets get lost. At 1 % of them hardly any message would come whole: it has
/// dozens. Throws Error.
inline NodeWire node_wire(const CameraUri& uri) {
  NodeWire wire{parse_ros2_network(uri)};
  if (wire.network.interface.empty()) return wire;
  // Who has keys shows certificates, which Fast DDS cannot divide into packets.
  wire.network.in_packets = wire.network.keys.empty();
  wire.delivery = dds::Delivery::reliable;
  return wire;
}

}  // namespace diminish
