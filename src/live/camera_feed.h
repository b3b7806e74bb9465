#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "diminish/live.h"
#include "live/arrival_signal.h"
#include "live/camera_inbox.h"
#include "live/sliding_window.h"

namespace diminish {

/// Reads a camera in its own thread, reopens it when it is lost, and counts what goes wrong.
class CameraFeed {
 public:
  /// inbox and arrived must outlive this.
  CameraFeed(LiveCamera camera, const CameraRequest& request, CameraInbox& inbox,
             ArrivalSignal& arrived);
  /// Waits for the camera's thread to end.
  ~CameraFeed();
  CameraFeed(const CameraFeed&) = delete;
  CameraFeed& operator=(const CameraFeed&) = delete;

  /// Asks the thread to end. Does not wait.
  void stop() { stopped_ = true; }
  CameraStatus status() const;

 private:
  void work();
  void read_until_gone();
  void take(CameraImage& image);
  std::size_t images() const;
  /// problem: empty to leave it as it is. Throws nothing.
  void set_state(CameraState state, const char* problem);
  void wait_before_reopening(double seconds) const;

  LiveCamera camera_;
  CameraRequest request_;
  CameraInbox& inbox_;
  ArrivalSignal& arrived_;
  std::atomic<bool> stopped_ = false;
  mutable std::mutex mutex_;
  CameraStatus status_;
  SlidingWindow arrivals_s_{60};
  std::size_t dropped_before_ = 0;  ///< by sources closed since then
  double last_image_s_ = 0;
  bool has_color_ = false;
  std::thread thread_;
};

}  // namespace diminish
