#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "diminish/image.h"
#include "ros/messages.h"

namespace diminish::ros {

/// Reads a depth image of ROS's compressed_depth_image_transport: PNG or RVL, of 16UC1
/// (millimetres) or of 32FC1 (metres, stored as inverse depth). depth: in units of `unit_m`; 0
/// where nothing was measured, or more than 16 bits hold. Throws Error (input).
void read_compressed_depth(const CompressedImageMessage& message, double unit_m,
                           Image<std::uint16_t>& depth);

/// Writes the payload of such a message, as RVL. The image's unit should be ROS's, a millimetre;
/// values are kept as they are. Returns the message's format.
std::string write_compressed_depth(const ImageView<std::uint16_t>& depth,
                                   std::vector<std::uint8_t>& data);

}  // namespace diminish::ros
