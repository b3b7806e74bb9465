#pragma once

#include <array>
#include <cstddef>

namespace diminish::ros {

/// How another machine's clock relates to ours, from messages' stamps on theirs and arrivals on
/// ours. Messages take time on their way, never less than none: the line below all delays that is
/// nearest to them is the two clocks' offset, drift included, and the shortest way. Source: Moon,
/// Skelly, Towsley, Estimation and Removal of Clock Skew from Network Delay Measurements, 1999.
/// Keeps the shortest delay of each second of the last minute. Cost of a message: about a
/// microsecond.
class ClockEstimate {
 public:
  /// A message. A stamp that has jumped makes the estimate begin anew: further ahead at once,
  /// further back when ten in a row say so.
  void add(double stamp_s, double arrival_s);

  bool empty() const { return count_ == 0; }
  /// Our clock less theirs, and the shortest way, at one of their times. Seconds.
  double offset_s(double stamp_s) const { return offset_s_ + drift_ * (stamp_s - origin_s_); }
  /// Seconds that our clock gains on theirs in a second of theirs; 0 before ten seconds are known.
  double drift() const { return drift_; }

 private:
  struct Delay {
    double stamp_s = 0, delay_s = 0;
  };
  void restart();
  void fit();

  static constexpr std::size_t capacity = 64;
  std::array<Delay, capacity> shortest_{};  ///< of each second, in order, the last `count_`
  std::size_t count_ = 0, next_ = 0;
  int late_ = 0;  ///< messages in a row whose stamps have jumped back
  double origin_s_ = 0, offset_s_ = 0, drift_ = 0;
};

}  // namespace diminish::ros
