#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "diminish/frame_source.h"

namespace diminish {

/// A recording's frames again and again, without end, read from its files each time.
class LoopedRecording : public FrameSource {
 public:
  LoopedRecording(const Recording& recording, const Options& options)
      : recording_(recording), options_(options) {}

  bool next(FrameSet& frame) override {
    if (!begin(frame)) return false;
    read_images(frame);
    return true;
  }

  bool begin(FrameSet& frame) override {
    if (laps_.empty() || !laps_.back()->begin(frame)) {
      laps_.push_back(open_recording(recording_, options_));
      if (!laps_.back()->begin(frame)) return false;
    }
    return true;
  }

  /// Laps are alike, so the first can read what another began.
  void read_images(FrameSet& frame) override { laps_.front()->read_images(frame); }

 private:
  const Recording& recording_;
  const Options& options_;
  std::vector<std::unique_ptr<FrameSource>> laps_;
};

}  // namespace diminish
