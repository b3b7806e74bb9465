#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace diminish {

/// A node's monotonic clock, by the times of questions and answers (as NTP does, RFC 5905): of the
/// last ones, that which was on its way for the shortest time counts.
class NodeClock {
 public:
  /// asked_s, arrived_s: on this machine's clock. received_s, sent_s: on the node's.
  void add(double asked_s, double received_s, double sent_s, double arrived_s) {
    const Sample sample{((received_s - asked_s) + (sent_s - arrived_s)) / 2,
                        (arrived_s - asked_s) - (sent_s - received_s)};
    if (!(sample.way_s >= 0)) return;
    // Another machine, or one that was started anew.
    const auto known = offset_s();
    if (known && std::abs(sample.offset_s - *known) > sample.way_s + jump_s) count_ = 0;
    samples_[count_++ % samples_.size()] = sample;
  }

  /// The node's clock less this machine's; nothing before the first answer.
  std::optional<double> offset_s() const {
    if (count_ == 0) return std::nullopt;
    const auto end =
        samples_.begin() + static_cast<std::ptrdiff_t>(std::min(count_, samples_.size()));
    return std::min_element(samples_.begin(), end,
                            [](const Sample& a, const Sample& b) { return a.way_s < b.way_s; })
        ->offset_s;
  }

 private:
  static constexpr double jump_s = 0.02;
  struct Sample {
    double offset_s, way_s;  ///< way_s: there and back
  };

  std::array<Sample, 64> samples_{};
  std::size_t count_ = 0;
};

}  // namespace diminish
