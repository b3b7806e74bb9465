#pragma once

namespace diminish {

/// How far off a depth may be and still belong to a surface: depth sensors' errors grow with the
/// square of the distance (for the first Kinect: Khoshelham & Elberink 2012).
struct DepthNoise {
  float constant_m = 0.008F;
  float by_square = 0.004F;  ///< metres per square metre

  float at(float depth_m) const { return constant_m + by_square * depth_m * depth_m; }
};

}  // namespace diminish
