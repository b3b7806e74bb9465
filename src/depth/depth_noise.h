#pragma once

namespace diminish {

/// What a depth may be off by without being of another surface: depth sensors' errors grow with the
/// square of the distance (for the first Kinect: Khoshelham & Elberink 2012).
struct DepthNoise {
  float constant_m = 0.008F;
  float by_square = 0.004F;  ///< metres a square metre

  float at(float depth_m) const { return constant_m + by_square * depth_m * depth_m; }
};

}  // namespace diminish
