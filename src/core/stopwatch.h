#pragma once

#include <chrono>

#include "diminish/diminished_frame.h"

namespace diminish {

/// Adds the time between its construction and destruction to a stage's milliseconds.
class ScopedTimer {
 public:
  ScopedTimer(StageTimes& milliseconds, Stage stage)
      : total_ms_(milliseconds[static_cast<std::size_t>(stage)]) {}
  ~ScopedTimer() {
    total_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& total_ms_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace diminish
