#pragma once

#include <vector>

#include "dds/dds.h"
#include "diminish/camera_source.h"

namespace diminish {

/// The cameras that these topics are of: a camera-node, a topic of depth with the colour whose name
/// is most like it, or a topic of colour. What is not a topic by ROS's rules is left out.
std::vector<CameraDevice> ros2_devices(const std::vector<dds::Topic>& topics);

/// Those on the air, on this machine, in ROS_DOMAIN_ID's domain. Listens for a second and a half.
std::vector<CameraDevice> list_ros2_devices();

}  // namespace diminish
