#pragma once

#include <opencv2/core.hpp>
#include <string_view>

#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// What an Azure Kinect knows of its two sensors.
struct KinectCalibration {
  Intrinsics color, depth;
  RigidTransform color_from_depth;
};

/// Reads the calibration that the device keeps (JSON, in units of the whole sensors), for images of
/// these sizes: they tell the modes, that is, what is binned and cropped. Depth: 320x288, 640x576
/// (narrow), 512x512, 1024x1024 (wide). Colour: the 4:3 picture, or its middle. Throws Error
/// (input) that says what was expected.
KinectCalibration read_kinect_calibration(std::string_view json, cv::Size color, cv::Size depth);

}  // namespace diminish
