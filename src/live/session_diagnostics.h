#pragma once

#include "diminish/live.h"
#include "ros/messages.h"

namespace diminish {

/// A session's state as ROS tells it: one status of the result, one of each camera.
ros::DiagnosticArray diagnostics_of(const LiveStatus& status);

}  // namespace diminish
