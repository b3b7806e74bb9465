#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diminish/camera_source.h"
#include "diminish/diminished_frame.h"
#include "diminish/export.h"
#include "diminish/frame_set.h"
#include "diminish/options.h"
#include "diminish/rig.h"
#include "diminish/scan.h"
#include "diminish/scene.h"

namespace diminish {

enum class CameraState { opening, running, silent, lost, ended };
inline constexpr std::array<const char*, 5> camera_state_names = {"opening", "running", "silent",
                                                                  "lost", "ended"};

/// How a camera whose images stay on another machine (`diminish render-node`) answers. Counters
/// cover the whole session, times the last few seconds.
struct RemoteStatus {
  std::size_t frames = 0;  ///< that it was asked about
  /// What came of it in time: first what poses and colours are found from, then its contribution to
  /// the picture, where one was asked for.
  std::size_t glances = 0, asked_layers = 0, layers = 0;
  std::size_t bytes_received = 0, bytes_sent = 0;
  /// Medians, milliseconds: from the question to the contribution, and how much of that is the way
  /// there and back.
  double layer_ms = 0, way_ms = 0;
  /// What a frame's questions and answers cost this machine, but for what Fast DDS does: the mean,
  /// in milliseconds of one core.
  double own_ms = 0;
};

/// A camera's status. Counters cover the whole session.
struct CameraStatus {
  std::string name, uri;
  CameraState state = CameraState::opening;
  /// The last thing that went wrong, in plain words; empty if nothing did.
  std::string problem;
  double images_per_second = 0;  ///< of colour, if the camera has it
  std::size_t images = 0;        ///< usable images
  std::size_t dropped = 0;       ///< by the camera's driver, if it says so
  std::size_t duplicates = 0;    ///< with the same timestamp as the one before
  std::size_t out_of_order = 0;  ///< with an earlier timestamp, or one in the future
  std::size_t wrong_size = 0;
  std::size_t damaged = 0;
  std::size_t stalls = 0;      ///< times without an image for a second or more
  std::size_t failures = 0;    ///< times that it could not be opened, or was lost
  std::size_t reconnects = 0;  ///< times that it came back
  /// Of images that another machine stamps (CameraSource::clock).
  std::optional<CameraClock> clock;
  /// Of one whose images stay on another machine.
  std::optional<RemoteStatus> remote;
};

/// A result of a live session, with its input.
struct LiveFrame {
  FrameSet input;                                   ///< views
  std::vector<std::shared_ptr<const void>> pixels;  ///< keeps what `input` views
  DiminishedFrame result;  ///< without its reconstruction (Pipeline::want_reconstruction)
  std::size_t number = 0;  ///< counts from 1
  double latency_ms = 0;   ///< from the colour image's timestamp to here
  double published_s = 0;  ///< on the monotonic clock
};

/// Milliseconds.
struct LatencyStatus {
  double p50 = 0, p95 = 0, p99 = 0;
};

/// A session's status. Small enough to request many times a second.
struct LiveStatus {
  bool running = false;
  bool ended = false;       ///< the colour camera has no more images, and all are shown
  std::size_t frames = 0;   ///< shown
  std::size_t skipped = 0;  ///< colour images skipped for newer ones
  std::size_t failed = 0;   ///< frames that ended in an error (see `problems`)
  double frames_per_second = 0;
  LatencyStatus latency_ms;  ///< of the last few seconds
  StageTimes stage_ms{};     ///< of the last frame
  double frame_ms = 0;       ///< of the last frame, all stages
  double budget_ms = 0;      ///< 0: none
  int quality_level = 0;     ///< 0: as chosen
  std::string quality;       ///< what is dropped, in plain words; empty at level 0
  std::vector<CameraStatus> cameras;
  std::vector<bool> posed;  ///< of the last frame: whether each RGB-D camera's pose is known
  std::vector<std::size_t> markers;  ///< seen by the colour camera and each RGB-D camera
  std::vector<OccluderReport> occluders;
  double mask_share = 0;  ///< of the picture
  /// Of the mask: seen by an RGB-D camera now (the witnessed ones too), remembered, seen without
  /// depth, invented.
  double seen_share = 0, witnessed_share = 0, remembered_share = 0, estimated_share = 0;
  double invented_share = 0;
  std::string evidence;               ///< these in plain words
  MemoryReport memory;                ///< of the last frame
  std::vector<std::string> problems;  ///< what is wrong now, in plain words
};

struct LiveOptions {
  /// Threads to use inside a frame; 0: one per core.
  int threads = 0;
  /// How many frames are worked on at the same time. Two raise the rate where a frame takes longer
  /// than the cameras' period; on few cores they delay each other. 0: two with four threads or
  /// more.
  int frames_in_flight = 0;
  /// Time budget of a frame. Quality steps down when frames take longer (docs/live.md lists the
  /// steps). 0: no budget.
  double budget_ms = 0;
  /// How long a colour image waits for its RGB-D images. 0: 0.02 s longer than the last few needed,
  /// at least 0.06 s.
  double sync_wait_s = 0;
  /// What was seen of the place before (Pipeline::set_background); null: nothing.
  std::shared_ptr<const Scan> background;
};

/// Cameras in, pictures out, until stopped. Each camera has a thread, and so has each frame in
/// flight. The newest images are processed and older ones skipped, so nothing queues up. A camera
/// that fails is opened again and again; meanwhile the session continues without it. All functions
/// may be called from any thread.
class DIMINISH_EXPORT LiveSession {
 public:
  /// Starts the session. Throws Error on a configuration that cannot work. A camera that cannot be
  /// opened is not an error: its state is `lost` until it can be opened.
  LiveSession(const Rig& rig, const Scene& scene, const Options& options,
              const std::vector<LiveCamera>& cameras, const LiveOptions& live_options);
  /// Stops the session and waits for its threads. From within a frame's `call` it cannot wait: the
  /// session stops, and what it holds is given back when its threads have ended.
  ~LiveSession();
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  const Rig& rig() const;
  const Scene& scene() const;
  Options options() const;
  /// Takes effect with the next frame. If a value is out of range, throws Error and changes
  /// nothing.
  void set_options(const Options& options);
  LiveOptions live_options() const;
  void set_budget_ms(double budget_ms);

  /// Forgets what was seen before the next frame (Pipeline::forget).
  void forget();

  LiveStatus status() const;

  /// The newest frame if its number is above `after`. Waits for it up to `timeout`; null if there
  /// was none. The caller may keep it. Slow callers get fewer frames.
  std::shared_ptr<const LiveFrame> wait_for_frame(std::size_t after,
                                                  std::chrono::milliseconds timeout) const;

  /// Registers `call` for every frame, in order. A pipeline's thread calls it, so it must return at
  /// once and not throw. Destroying the result removes it; it is not running any more then, unless
  /// it is `call` itself that destroys it.
  std::shared_ptr<void> on_frame(std::function<void(const std::shared_ptr<const LiveFrame>&)> call);

  /// Ends the frames' threads and tells the cameras' threads to end; the destructor waits for
  /// those. `wait_for_frame` returns null from now on. From within a frame's `call`, it returns
  /// before that frame's thread has ended.
  void stop();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
