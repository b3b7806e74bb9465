#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "core/set_text.h"
#include "core/thread_name.h"
#include "diminish/live.h"

namespace diminish {

/// Hands a session's newest frame to `write` on a thread of its own, until it is destroyed, the
/// session ends or `write` throws.
class FrameForwarder {
 public:
  FrameForwarder(const LiveSession& session, std::function<void(const LiveFrame&)> write)
      : write_(std::move(write)), thread_([this, &session] { run(session); }) {}
  ~FrameForwarder() {
    stopped_ = true;
    thread_.join();
  }
  FrameForwarder(const FrameForwarder&) = delete;
  FrameForwarder& operator=(const FrameForwarder&) = delete;

  /// What `write` threw; empty if nothing.
  std::string problem() const {
    const std::lock_guard lock(mutex_);
    return problem_;
  }

 private:
  void run(const LiveSession& session) {
    name_this_thread("forwarder");
    try {
      forward(session);
    } catch (const std::exception& error) {
      fail(error.what());
    } catch (...) {
      fail("an unknown error");
    }
  }
  void forward(const LiveSession& session) {
    constexpr std::chrono::milliseconds patience{100};
    std::size_t number = 0;
    while (!stopped_) {
      const auto frame = session.wait_for_frame(number, patience);
      if (!frame && !session.status().running) return;
      if (!frame) continue;
      number = frame->number;
      write_(*frame);
    }
  }
  void fail(const char* what) {
    const std::lock_guard lock(mutex_);
    set_text(problem_, what);
  }

  std::function<void(const LiveFrame&)> write_;
  std::atomic<bool> stopped_ = false;
  mutable std::mutex mutex_;  ///< guards the problem
  std::string problem_;
  std::thread thread_;  ///< last: it uses all of the above
};

}  // namespace diminish
