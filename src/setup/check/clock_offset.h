#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace diminish {

/// A place that moves, by one camera's clock.
struct TimedPoint {
  double stamp_s = 0;
  Eigen::Vector3d place;
};

struct ClockOffset {
  double offset_s = 0;  ///< the second clock shows so much more than the first at the same moment
  double deviation_s = 0;  ///< standard deviation
};

/// How far two cameras' clocks are apart, from one thing's way as both saw it. A constant distance
/// between the two ways is allowed, as calibration leaves one: so an even motion along a line says
/// nothing. Points in the order of time. Nothing if the ways have too little in common.
std::optional<ClockOffset> estimate_clock_offset(const std::vector<TimedPoint>& first,
                                                 const std::vector<TimedPoint>& second,
                                                 double largest_s = 1);

}  // namespace diminish
