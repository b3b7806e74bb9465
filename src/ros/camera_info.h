#pragma once

#include "diminish/intrinsics.h"
#include "ros/messages.h"

namespace diminish::ros {

/// A camera_info's lens: plumb_bob, rational_polynomial or equidistant, with its part of the
/// picture and its binning (as ROS's image_geometry reads them). is_rectified: the images have no
/// distortion any more; the lens is then that of `p`. Throws Error (input) that says what was
/// expected.
Intrinsics intrinsics_of(const CameraInfoMessage& info, bool is_rectified);

CameraInfoMessage camera_info(const Intrinsics& camera);

}  // namespace diminish::ros
