#include "ros/clock_estimate.h"

#include <cmath>

namespace diminish::ros {
namespace {

constexpr double bucket_s = 1;
constexpr double jump_s = 1;
constexpr int late_before_restart = 10;
constexpr double least_span_s = 10;
/// Quartz is off by up to 100 ppm; what is more is no drift.
constexpr double most_drift = 1e-3;

}  // namespace

void ClockEstimate::restart() {
  count_ = next_ = 0;
  late_ = 0;
  drift_ = 0;
}

void ClockEstimate::add(double stamp_s, double arrival_s) {
  const double delay_s = arrival_s - stamp_s;
  if (!std::isfinite(delay_s)) return;
  if (!empty()) {
    const double above_s = delay_s - offset_s(stamp_s);
    if (above_s < -jump_s) restart();
    if (above_s <= jump_s) {
      late_ = 0;
    } else if (++late_ < late_before_restart) {
      return;
    } else {
      restart();
    }
  }
  Delay& last = shortest_[(next_ + capacity - 1) % capacity];
  if (count_ > 0 && std::floor(last.stamp_s / bucket_s) == std::floor(stamp_s / bucket_s)) {
    if (delay_s >= last.delay_s) return;
    last = {stamp_s, delay_s};
  } else if (count_ > 0 && stamp_s < last.stamp_s) {
    return;  // out of order
  } else {
    shortest_[next_] = {stamp_s, delay_s};
    next_ = (next_ + 1) % capacity;
    count_ = count_ < capacity ? count_ + 1 : capacity;
  }
  fit();
}

void ClockEstimate::fit() {
  const auto at = [&](std::size_t i) {
    return shortest_[(next_ + capacity - count_ + i) % capacity];
  };
  origin_s_ = at(0).stamp_s;
  offset_s_ = at(0).delay_s;
  drift_ = 0;
  double mean_s = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    mean_s += (at(i).stamp_s - origin_s_) / static_cast<double>(count_);
    offset_s_ = std::fmin(offset_s_, at(i).delay_s);
  }
  if (at(count_ - 1).stamp_s - origin_s_ < least_span_s) return;
  // Of all lines below the delays, the one with the least sum of distances: an edge of the lower
  // hull, the one around their mean.
  std::array<Delay, capacity> hull;
  std::size_t corners = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Delay point{at(i).stamp_s - origin_s_, at(i).delay_s};
    const auto turns_up = [&] {
      const Delay& a = hull[corners - 2];
      const Delay& b = hull[corners - 1];
      return (b.stamp_s - a.stamp_s) * (point.delay_s - a.delay_s) >
             (point.stamp_s - a.stamp_s) * (b.delay_s - a.delay_s);
    };
    while (corners >= 2 && !turns_up()) --corners;
    hull[corners++] = point;
  }
  for (std::size_t i = 0; i + 1 < corners; ++i) {
    if (hull[i + 1].stamp_s < mean_s) continue;
    const double slope =
        (hull[i + 1].delay_s - hull[i].delay_s) / (hull[i + 1].stamp_s - hull[i].stamp_s);
    if (std::abs(slope) > most_drift) return;
    drift_ = slope;
    offset_s_ = hull[i].delay_s - slope * hull[i].stamp_s;
    return;
  }
}

}  // namespace diminish::ros
