#pragma once

#include <optional>

#include "camera/ros2_address.h"
#include "ros/clock_estimate.h"

namespace diminish {

/// Brings a sender's stamps to this machine's monotonic clock.
class SenderClock {
 public:
  explicit SenderClock(Ros2Address::Clock kind) : kind_(kind) {}

  /// stamp_s: on the sender's clock, UTC if it is right. arrival_s: on the monotonic one.
  /// utc_from_monotonic_s: this machine's UTC less its monotonic clock. Returns when the message
  /// was stamped, on the monotonic clock; at most its arrival.
  double local_s(double stamp_s, double arrival_s, double utc_from_monotonic_s);
  /// To be added to the sender's stamps, as they are understood since the last one.
  double offset_s() const;
  /// Nothing before the first stamp.
  std::optional<CameraClock> state() const;

 private:
  Ros2Address::Clock kind_;
  ros::ClockEstimate estimate_;
  std::optional<bool> is_trusted_;
  double last_stamp_s_ = 0;
  double utc_from_monotonic_s_ = 0;
};

/// This machine's UTC less its monotonic clock, seconds.
double utc_from_monotonic_s();

}  // namespace diminish
