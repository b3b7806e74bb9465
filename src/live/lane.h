#pragma once

#include <fmt/format.h>

#include <atomic>
#include <cstddef>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/turns.h"
#include "diminish/camera_source.h"
#include "diminish/pipeline.h"
#include "live/remote_camera.h"

namespace diminish {

/// A frame in flight: a pipeline and the thread that works on it.
struct Lane {
  Lane(const Rig& rig, const Scene& scene, const Options& options) : pipeline(rig, scene, options) {
    pipeline.want_reconstruction(false);
  }

  Pipeline pipeline;
  /// To the cameras on other machines, about its frame; null: a local one.
  std::vector<std::unique_ptr<RemoteCamera::Question>> questions;
  Turn publishing;
  std::size_t options_version = 0;         ///< of those that the pipeline has
  std::atomic<double> begun_s = 0;         ///< its frame, on the monotonic clock; 0: none
  std::atomic<std::thread::id> thread_id;  ///< may be read while `thread` is waited for
  std::thread thread;

  /// While it works on a frame.
  class Busy {
   public:
    explicit Busy(Lane& lane) : lane_(lane) { lane.begun_s = monotonic_now_s(); }
    ~Busy() { lane_.begun_s = 0; }
    Busy(const Busy&) = delete;
    Busy& operator=(const Busy&) = delete;

   private:
    Lane& lane_;
  };

  /// The watchdog: names the stage that does not end. Empty: all is well.
  std::string stuck_frame(double now_s) const {
    constexpr double stuck_after_s = 2;
    const double since_s = begun_s;
    if (since_s == 0 || now_s - since_s < stuck_after_s) return {};
    const auto stage = pipeline.stage();
    return fmt::format("a frame takes {:.0f} s so far, in stage: {}", now_s - since_s,
                       stage ? stage_names[static_cast<std::size_t>(*stage)]
                             : "none (a change of options, or a call of on_frame)");
  }
};

}  // namespace diminish
