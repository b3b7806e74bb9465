#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "diminish/frame_source.h"

namespace diminish {

/// Hands out decoded frames again and again, `count` in all, without copying: a frame is exchanged
/// for the one that the caller had before.
class PreloadedSource : public FrameSource {
 public:
  PreloadedSource(std::vector<FrameSet> frames, std::size_t count)
      : frames_(std::move(frames)), count_(count) {}

  bool next(FrameSet& frame) override {
    if (done_ == count_) return false;
    FrameSet& stored = frames_[done_ % frames_.size()];
    if (frame.color.empty()) {
      frame = stored;
    } else {
      std::swap(frame, stored);
    }
    frame.index = done_++;
    return true;
  }

 private:
  std::vector<FrameSet> frames_;
  std::size_t count_;
  std::size_t done_ = 0;
};

}  // namespace diminish
