#pragma once

#include <array>
#include <string>

#include "diminish/options.h"
#include "live/sliding_window.h"

namespace diminish {

/// Keeps frames within a time budget, also while other programs slow the machine: lowers the
/// quality when most of the last few frames took longer, and raises it when it would fit again.
/// What a step saves is measured when it is taken.
class QualityLadder {
 public:
  static constexpr int last_level = 5;

  /// What a level drops of these options, in plain words; empty if nothing.
  static std::string description(const Options& options, int level);
  /// The options with a level's simplifications. Level 0: as chosen. Does not override a simpler
  /// choice.
  static Options simplified(const Options& options, int level);

  /// Takes the time of the last frame and returns the level for the next one. Levels that change
  /// none of the options are passed over. budget_ms: 0 means no budget and level 0.
  int next_level(double frame_ms, double budget_ms, const Options& options);

  int level() const { return level_; }

 private:
  void change_level(int by, const Options& options);

  int level_ = 0;
  SlidingWindow times_ms_{9};                   ///< of frames at this level
  bool has_stepped_down_ = false;               ///< and how much that has saved is not known yet
  double ms_before_ = 0;                        ///< usual, before the last step down
  std::array<double, last_level + 1> costs_{};  ///< a frame one level up, compared with this level
  int frames_under_ = 0;                        ///< in a row, with time for one level up
};

}  // namespace diminish
