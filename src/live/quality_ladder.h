#pragma once

#include <string>

#include "diminish/options.h"

namespace diminish {

/// Keeps frames within a budget: steps quality down when they take more, and up again when there is
/// time for it. Each step gives up what is seen least for the time that it takes.
class QualityLadder {
 public:
  /// The steps, the first to go first. 0: as chosen.
  static int last_level();
  /// What a level simplifies, in plain words; empty for 0.
  static std::string description(int level);
  /// The options with a level's simplifications. A choice that is already simpler stays.
  static Options simplified(const Options& options, int level);

  /// Says how long a frame took; returns the level for the next one.
  /// budget_ms: 0: none, the level becomes 0.
  int next_level(double frame_ms, double budget_ms);

  int level() const { return level_; }

 private:
  void change_level(int by);

  int level_ = 0;
  int frames_over_ = 0;            ///< in a row, of the budget
  int frames_under_ = 0;           ///< in a row, well below it
  int patience_ = 0;               ///< frames to be well below it before the next step up
  int frames_since_up_ = 1000000;  ///< since the last step up
};

}  // namespace diminish
