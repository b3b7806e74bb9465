#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "diminish/camera_source.h"
#include "diminish/diminished_frame.h"
#include "diminish/export.h"
#include "diminish/frame_set.h"
#include "diminish/options.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// A camera of a live session. An RGB-D camera whose sensors are separate devices has two.
struct LiveCamera {
  std::string name;  ///< "color", or an RGB-D camera's name in the rig
  std::string uri;
};

enum class CameraState { opening, running, silent, lost, ended };
inline constexpr std::array<const char*, 5> camera_state_names = {"opening", "running", "silent",
                                                                  "lost", "ended"};

/// How a camera does. Counters are of the whole session.
struct CameraStatus {
  std::string name, uri;
  CameraState state = CameraState::opening;
  /// The last thing that went wrong, in plain words; empty if nothing did.
  std::string problem;
  double images_per_second = 0;  ///< colour, where the camera has it
  std::size_t images = 0;        ///< usable ones
  std::size_t dropped = 0;       ///< by the camera's driver, as far as it says
  std::size_t duplicates = 0;    ///< with the timestamp of the one before
  std::size_t out_of_order = 0;  ///< with an earlier timestamp, or one in the future
  std::size_t wrong_size = 0;
  std::size_t damaged = 0;
  std::size_t stalls = 0;      ///< times without an image for a second or more
  std::size_t failures = 0;    ///< times that it could not be opened or was lost
  std::size_t reconnects = 0;  ///< times that it came back
};

/// What a live session produced, with what it was made from.
struct LiveFrame {
  FrameSet input;
  DiminishedFrame result;  ///< without its reconstruction (Pipeline::want_reconstruction)
  std::size_t number = 0;  ///< counts from 1
  double latency_ms = 0;   ///< from the colour image's timestamp to here
  double published_s = 0;  ///< on the monotonic clock
};

/// Milliseconds.
struct LatencyStatus {
  double p50 = 0, p95 = 0, p99 = 0;
};

/// How a session does. Small enough to be asked for many times a second.
struct LiveStatus {
  bool running = false;
  bool ended = false;       ///< the colour camera has no more images, and all are shown
  std::size_t frames = 0;   ///< shown
  std::size_t skipped = 0;  ///< colour images that were never shown: newer ones were there
  std::size_t failed = 0;   ///< frames that ended in an error (see `problems`)
  double frames_per_second = 0;
  LatencyStatus latency_ms;  ///< of the last few seconds
  StageTimes stage_ms{};     ///< of the last frame
  double frame_ms = 0;       ///< of the last frame, all stages
  double budget_ms = 0;      ///< 0: none
  int quality_level = 0;     ///< 0: as chosen
  std::string quality;       ///< what is simplified, in plain words; empty at level 0
  std::vector<CameraStatus> cameras;
  std::vector<bool> posed;           ///< of the last frame: the pose of each RGB-D camera is known
  std::vector<std::size_t> markers;  ///< seen by the colour camera and each RGB-D camera
  std::vector<OccluderReport> occluders;
  double mask_share = 0;              ///< of the picture
  double seen_share = 0;              ///< of the mask
  std::vector<std::string> problems;  ///< what is wrong now, in plain words
};

struct LiveOptions {
  /// Threads that work on a frame; 0: all cores.
  int threads = 0;
  /// What a frame may take; quality steps down (docs/live.md says in which order) when it takes
  /// more. 0: as long as it takes.
  double budget_ms = 0;
  /// How long a colour image waits for its RGB-D images; 0: 0.02 s longer than the last few of them
  /// made it wait, at least 0.06 s.
  double sync_wait_s = 0;
};

/// Cameras in, pictures out, until stopped. The cameras have a thread each, the pipeline has one;
/// whoever looks has his own. The newest images are worked on, older ones are left out; nothing
/// queues up. Cameras that fail are opened again and again; meanwhile the session goes on with what
/// it has. All functions may be called from any thread.
class DIMINISH_EXPORT LiveSession {
 public:
  /// Starts. Throws Error on a configuration that cannot work; a camera that cannot be opened is
  /// none: it is lost until it can.
  LiveSession(const Rig& rig, const Scene& scene, const Options& options,
              const std::vector<LiveCamera>& cameras, const LiveOptions& live_options);
  /// Stops.
  ~LiveSession();
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  const Rig& rig() const;
  const Scene& scene() const;
  Options options() const;
  /// Takes effect with the next frame. Throws Error on values out of range and changes nothing.
  void set_options(const Options& options);
  LiveOptions live_options() const;
  void set_budget_ms(double budget_ms);

  LiveStatus status() const;

  /// The newest frame if its number is above `after`; waits for it, at most `timeout`, and returns
  /// null when there was none. It is the caller's to keep; those who are slow get fewer frames.
  std::shared_ptr<const LiveFrame> wait_for_frame(std::size_t after,
                                                  std::chrono::milliseconds timeout) const;

  /// Called with every frame, in order, by the pipeline's thread: must return at once and not
  /// throw. Returns what removes it again when destroyed.
  std::shared_ptr<void> on_frame(std::function<void(const std::shared_ptr<const LiveFrame>&)> call);

  /// Ends the cameras' and the pipeline's threads. `wait_for_frame` returns from now on.
  void stop();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
