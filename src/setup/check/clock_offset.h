#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace diminish {

/// A moving point, timed by one camera's clock.
struct TimedPoint {
  double stamp_s = 0;
  Eigen::Vector3d place;
};

struct ClockOffset {
  double offset_s = 0;     ///< second clock minus first clock at the same moment
  double deviation_s = 0;  ///< standard deviation
};

/// How far apart two cameras' clocks are, from the path of one object as both saw it. The paths may
/// differ by a constant distance, which calibration leaves, so uniform motion along a line says
/// nothing. Points are in the order of time. Nothing if the paths have too little in common.
std::optional<ClockOffset> estimate_clock_offset(const std::vector<TimedPoint>& first,
                                                 const std::vector<TimedPoint>& second,
                                                 double largest_s = 1);

}  // namespace diminish
