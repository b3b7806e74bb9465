#pragma once

#include <string>

#include "diminish/options.h"

namespace diminish {

/// Keeps frames within a time budget: lowers the quality when they take longer and raises it when
/// there is time. Each step drops what is least visible for the time that it takes.
class QualityLadder {
 public:
  /// The number of steps. Level 0: as chosen.
  static int last_level();
  /// What a level drops, in plain words; empty for 0.
  static std::string description(int level);
  /// The options with a level's simplifications. Does not override a simpler choice.
  static Options simplified(const Options& options, int level);

  /// Takes the time of the last frame and returns the level for the next one. budget_ms: 0 means no
  /// budget and level 0.
  int next_level(double frame_ms, double budget_ms);

  int level() const { return level_; }

 private:
  void change_level(int by);

  int level_ = 0;
  int frames_over_ = 0;            ///< in a row, over the budget
  int frames_under_ = 0;           ///< in a row, well below the budget
  int patience_ = 0;               ///< frames well below the budget that a step up needs
  int frames_since_up_ = 1000000;  ///< since the last step up
};

}  // namespace diminish
