#pragma once

#include <string>

namespace diminish {

/// A type's fields in ROS's language, with those of the types that it uses: what an MCAP file says
/// of its messages. Of those types that bags are written of (ros/messages.h); empty for others.
std::string message_definition(const std::string& type);

}  // namespace diminish
