#pragma once

#include <cstddef>
#include <mutex>
#include <string>

#include "diminish/live.h"
#include "diminish/options.h"
#include "diminish/pipeline.h"
#include "live/quality_ladder.h"

namespace diminish {

/// The options of a live session, which may change while frames are in progress: each pipeline
/// takes them between two of its frames, simplified as the time budget demands. All functions may
/// be called from any thread.
class LiveSettings {
 public:
  LiveSettings(const Options& options, double budget_ms)
      : options_(options), last_good_(options), budget_ms_(budget_ms) {}

  Options options() const;
  double sync_tolerance_s() const;
  /// They have been checked.
  void set_options(const Options& options);
  double budget_ms() const;
  void set_budget_ms(double budget_ms);

  /// Gives a pipeline the options, if it has others. version: of those that it has. Options that do
  /// not work here are replaced by the last that did, for all.
  void apply(Pipeline& pipeline, std::size_t& version);
  /// Takes the time of the last frame.
  void keep_budget(double frame_ms);
  /// The budget, the quality, and what is wrong with the options.
  void describe(LiveStatus& status) const;

 private:
  mutable std::mutex mutex_;  ///< guards all that follows
  Options options_, last_good_;
  double budget_ms_;
  QualityLadder ladder_;
  std::size_t version_ = 1;  ///< of the options and the quality's level
  std::string problem_;
};

}  // namespace diminish
