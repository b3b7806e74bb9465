#pragma once

#include <algorithm>
#include <thread>

#include "diminish/frame_source.h"
#include "diminish/live.h"

namespace diminish {

/// A live session's input as a FrameSource. Ends after `seconds`, or when no frame comes for that
/// long.
class LiveFrameSource : public FrameSource {
 public:
  LiveFrameSource(const LiveSession& session, double seconds)
      : session_(session), seconds_(seconds), end_s_(monotonic_now_s() + seconds) {}

  bool next(FrameSet& frame) override {
    if (index_ == 0) wait_for_cameras();
    if (monotonic_now_s() > end_s_) return false;
    const auto patience = std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::duration<double>(seconds_));
    const auto live = session_.wait_for_frame(number_, patience);
    if (!live) return false;
    number_ = live->number;
    frame = live->input;
    frame.index = index_++;
    return true;
  }

 private:
  /// The first frames lack cameras that take longer to open.
  void wait_for_cameras() {
    const auto is_opening = [](const CameraStatus& camera) {
      return camera.state == CameraState::opening;
    };
    LiveStatus status = session_.status();
    while (monotonic_now_s() < end_s_ &&
           std::any_of(status.cameras.begin(), status.cameras.end(), is_opening)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      status = session_.status();
    }
    number_ = status.frames + 1;  // one may be in progress
  }

  const LiveSession& session_;
  double seconds_;
  double end_s_;
  std::size_t number_ = 0;
  std::size_t index_ = 0;
};

}  // namespace diminish
