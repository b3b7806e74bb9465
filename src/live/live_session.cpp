#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <thread>
#include <utility>

#include "core/set_text.h"
#include "core/shared_tasks.h"
#include "core/thread_name.h"
#include "diminish/error.h"
#include "diminish/live.h"
#include "diminish/pipeline.h"
#include "live/camera_feed.h"
#include "live/frame_assembler.h"
#include "live/frame_listeners.h"
#include "live/lane.h"
#include "live/live_settings.h"
#include "live/pool.h"
#include "live/remote_camera.h"
#include "live/session_status.h"
#include "sink/distribution.h"
#include "source/find_camera.h"

namespace diminish {
namespace {

constexpr std::size_t window_frames = 150;
/// With fewer, a second frame would only delay the first.
constexpr int threads_for_two_frames = 4;

void check_cameras(const Rig& rig, const std::vector<LiveCamera>& cameras) {
  const auto is_used = [&](const std::string& name) {
    return std::any_of(cameras.begin(), cameras.end(),
                       [&](const LiveCamera& camera) { return camera.name == name; });
  };
  if (!is_used("color")) throw Error("color: expected a camera for the user's view");
  for (const LiveCamera& camera : cameras) {
    const bool is_known = camera.name == "color" || find_rgbd_camera(rig, camera.name);
    if (!is_known) throw Error(camera.name + ": the rig has no camera of this name");
    const CameraUri uri = parse_camera_uri(camera.uri);
    if (is_node_uri(camera.uri)) {
      if (camera.name == "color") uri.fail("the user's view cannot be a node that draws");
      continue;
    }
    using Sources = Registry<CameraSource>;
    if (!Sources::contains(uri.scheme)) uri.fail(Sources::unknown(uri.scheme));
  }
  for (const RgbdCamera& rgbd : rig.rgbd) {
    if (!is_used(rgbd.name)) throw Error(rgbd.name + ": expected a camera (--rgbd)");
  }
}

}  // namespace

struct LiveSession::Implementation {
  Implementation(const Rig& rig_, const Scene& scene_, const Options& options_,
                 const std::vector<LiveCamera>& cameras, const LiveOptions& live_options_)
      : rig(rig_),
        scene(scene_),
        live_options(live_options_),
        settings(options_, live_options_.budget_ms),
        assembler{make_inboxes(), rgbd_inboxes()} {  // braces: evaluated from left to right
    check_cameras(rig, cameras);
    const int lane_count = frames_in_flight();
    for (int i = 0; i < lane_count; ++i) {
      lanes.push_back(std::make_unique<Lane>(rig, scene, settings.options()));
      if (i > 0) lanes.back()->pipeline.share_memory(lanes.front()->pipeline);
    }
    if (live_options.background) {
      lanes.front()->pipeline.set_background(*live_options.background);
    }
    const double epoch_s = monotonic_now_s();
    open_remote(cameras);
    for (const LiveCamera& camera : cameras) {
      if (is_node_uri(camera.uri)) continue;
      CameraInbox& inbox = **std::find_if(inboxes.begin(), inboxes.end(), [&](const auto& box) {
        return box->name() == camera.name;
      });
      feeds.push_back(std::make_unique<CameraFeed>(
          camera, CameraRequest{camera.name, &rig, epoch_s}, inbox, arrived));
    }
    begin_threads();
  }

  ~Implementation() { stop(); }

  void begin_threads() {
    try {
      for (const auto& lane : lanes) lane->thread = std::thread([this, &lane] { work(*lane); });
    } catch (...) {  // the system has none to give: those that have begun must end
      stop();
      throw;
    }
  }

  void open_remote(const std::vector<LiveCamera>& cameras) {
    remotes.resize(rig.rgbd.size());
    const auto count = std::count_if(cameras.begin(), cameras.end(), [](const LiveCamera& camera) {
      return is_node_uri(camera.uri);
    });
    for (const LiveCamera& camera : cameras) {
      if (!is_node_uri(camera.uri)) continue;
      const RgbdCamera& rgbd = *find_rgbd_camera(rig, camera.name);
      remotes[static_cast<std::size_t>(&rgbd - rig.rgbd.data())] = std::make_unique<RemoteCamera>(
          camera, RemoteCamera::Setting{
                      rgbd, rig.color,
                      lanes.front()->pipeline.needs_markers() ? scene.marker_dictionary : "",
                      static_cast<std::size_t>(count)});
    }
  }

  CameraInbox& make_inboxes() {
    inboxes.push_back(std::make_unique<CameraInbox>("color", rig.color, std::nullopt));
    for (const RgbdCamera& camera : rig.rgbd) {
      const auto depth = camera.measures_depth ? std::optional(camera.depth) : std::nullopt;
      inboxes.push_back(std::make_unique<CameraInbox>(camera.name, camera.color, depth));
    }
    return *inboxes.front();
  }
  std::vector<CameraInbox*> rgbd_inboxes() const {
    std::vector<CameraInbox*> rgbd;
    for (std::size_t i = 1; i < inboxes.size(); ++i) rgbd.push_back(inboxes[i].get());
    return rgbd;
  }

  int threads() const {
    return live_options.threads > 0 ? live_options.threads
                                    : oneapi::tbb::this_task_arena::max_concurrency();
  }
  int frames_in_flight() const {
    if (live_options.frames_in_flight > 0) return live_options.frames_in_flight;
    return threads() >= threads_for_two_frames ? 2 : 1;
  }

  bool is_own_thread() const {
    return std::any_of(lanes.begin(), lanes.end(), [](const auto& lane) {
      return lane->thread_id == std::this_thread::get_id();
    });
  }

  void stop() {
    stopped = true;
    arrived.notify();
    published.notify();
    for (const auto& feed : feeds) feed->stop();
    // A listener's call: its thread ends when the call has returned.
    if (is_own_thread()) return;
    const std::lock_guard lock(ending);
    for (const auto& lane : lanes) {
      if (lane->thread.joinable()) lane->thread.join();
    }
  }

  void work(Lane& lane) {
    name_this_thread("frames");
    lane.thread_id = std::this_thread::get_id();
    std::shared_ptr<LiveFrame> frame;
    while (!stopped) {
      try {
        if (!frame) frame = pool.take();
        if (!begin_frame(lane, *frame)) continue;
        const Lane::Busy busy(lane);
        const ThreadBudget::Use use(budget);
        settings.apply(lane.pipeline, lane.options_version);
        for (std::size_t k = 0; k < lane.questions.size(); ++k) {
          if (lane.questions[k]) lane.questions[k]->wait(frame->input.rgbd[k]);
        }
        lane.pipeline.process(frame->input, frame->result);
        lane.publishing.wait(publishing);
        // Whatever fails from here on, what others may hold by then is not used again.
        publish(std::exchange(frame, nullptr));
      } catch (const std::exception& error) {
        note_failure(error.what());
      } catch (...) {
        note_failure("an unknown error");
      }
      lane.pipeline.pass_turn();
      lane.publishing.end();
    }
  }

  /// Waits for the next frame's images, for a while, and gives the frame its place in the order.
  bool begin_frame(Lane& lane, LiveFrame& frame) {
    const std::lock_guard lock(intake);
    if (stopped) return false;
    const std::size_t seen = arrived.count();
    if (!make_frame(frame)) {
      const auto deadline_s = assembler.next_deadline_s(sync_settings());
      if (!deadline_s) nothing_new_at = seen;
      arrived.wait(seen, waiting_time(deadline_s));
      return false;
    }
    const double tolerance_s = assembler.sync_tolerance_s(sync_settings());
    lane.questions.resize(remotes.size());
    for (std::size_t k = 0; k < remotes.size(); ++k) {
      if (remotes[k]) lane.questions[k] = remotes[k]->ask(frame.input.stamp_s, tolerance_s);
    }
    if (forget_wanted.exchange(false)) lane.pipeline.forget();
    lane.pipeline.take_turn();
    lane.publishing.take(publishing);
    return true;
  }

  FrameAssembler::Settings sync_settings() const {
    return {settings.sync_tolerance_s(), live_options.sync_wait_s};
  }

  static std::chrono::duration<double> waiting_time(std::optional<double> deadline_s) {
    constexpr double longest_s = 0.1;
    constexpr double shortest_s = 0.001;
    const double left_s = deadline_s ? *deadline_s - monotonic_now_s() : longest_s;
    return std::chrono::duration<double>(std::clamp(left_s, shortest_s, longest_s));
  }

  bool make_frame(LiveFrame& frame) {
    const double now_s = monotonic_now_s();
    const auto is_expected = [&](std::size_t k) {
      const auto last_s = inboxes[k + 1]->last_arrival_s();
      return last_s && now_s - *last_s < no_picture_after_s;
    };
    const auto passed_over =
        assembler.assemble(sync_settings(), now_s, is_expected, frame.input, frame.pixels);
    if (!passed_over) return false;
    const std::lock_guard lock(mutex);
    skipped += *passed_over;
    return true;
  }

  void publish(const std::shared_ptr<LiveFrame>& frame) {
    frame->published_s = monotonic_now_s();
    frame->latency_ms = 1000 * (frame->published_s - frame->input.stamp_s);
    {
      const std::lock_guard lock(mutex);
      frame->number = latest ? latest->number + 1 : 1;
      latest = frame;
      latencies_ms.add(frame->latency_ms);
      publish_times_s.add(frame->published_s);
      failure.clear();
    }
    settings.keep_budget(frame->result.report.frame_ms);
    listeners.call(frame);
    published.notify();
  }

  void note_failure(const char* what) {
    const std::lock_guard lock(mutex);
    ++failed;
    set_text(failure, what);
  }

  LiveStatus status() const;

  const Rig rig;
  const Scene scene;
  const LiveOptions live_options;  ///< the budget: as it was at first
  LiveSettings settings;
  mutable std::mutex mutex;  ///< guards the members up to the next blank line
  std::shared_ptr<const LiveFrame> latest;
  SlidingWindow latencies_ms{window_frames};
  SlidingWindow publish_times_s{window_frames};
  std::size_t skipped = 0, failed = 0;
  std::string failure;

  std::mutex intake;  ///< guards the assembler, and the order of frames
  std::vector<std::unique_ptr<CameraInbox>> inboxes;  ///< "color" and each RGB-D camera's
  FrameAssembler assembler;
  Turns publishing;

  Pool<LiveFrame> pool;
  ArrivalSignal arrived, published;
  FrameListeners listeners;
  std::atomic<bool> stopped = false, forget_wanted = false;
  std::atomic<std::size_t> nothing_new_at =
      0;  ///< the count of `arrived` up to which everything is shown
  std::vector<std::unique_ptr<CameraFeed>> feeds;
  std::vector<std::unique_ptr<RemoteCamera>> remotes;  ///< of each RGB-D camera; null: local
  ThreadBudget budget{std::max(threads(), frames_in_flight())};  ///< of all lanes together
  std::mutex ending;
  std::vector<std::unique_ptr<Lane>> lanes;
};

LiveStatus LiveSession::Implementation::status() const {
  LiveStatus status;
  status.running = !stopped;
  const std::lock_guard lock(mutex);
  for (const auto& feed : feeds) status.cameras.push_back(feed->status());
  for (const auto& remote : remotes) {
    if (remote) status.cameras.push_back(remote->status());
  }
  status.ended = describe_problems_of_cameras(status) && nothing_new_at == arrived.count();
  const double now_s = monotonic_now_s();
  if (!status.ended && (!latest || now_s - latest->published_s > no_picture_after_s)) {
    status.problems.emplace_back("no new picture");
  }
  status.skipped = skipped;
  status.failed = failed;
  status.frames_per_second = publish_times_s.rate();
  const Distribution latency = distribution_of(latencies_ms.values());
  status.latency_ms = {latency.p50, latency.p95, latency.p99};
  settings.describe(status);
  for (const auto& lane : lanes) {
    std::string stuck = lane->stuck_frame(now_s);
    if (!stuck.empty()) status.problems.push_back(std::move(stuck));
  }
  if (!failure.empty()) status.problems.push_back("the last frame failed: " + failure);
  if (latest) describe_last_frame(*latest, status);
  return status;
}

LiveSession::LiveSession(const Rig& rig, const Scene& scene, const Options& options,
                         const std::vector<LiveCamera>& cameras, const LiveOptions& live_options)
    : implementation_(
          std::make_unique<Implementation>(rig, scene, options, cameras, live_options)) {}
LiveSession::~LiveSession() {
  // From within a frame's call, its thread cannot be waited for here.
  if (implementation_->is_own_thread()) {
    std::thread([ending = std::move(implementation_)] { ending->stop(); }).detach();
  }
}

const Rig& LiveSession::rig() const {
  return implementation_->rig;
}
const Scene& LiveSession::scene() const {
  return implementation_->scene;
}
Options LiveSession::options() const {
  return implementation_->settings.options();
}
void LiveSession::set_options(const Options& options) {
  check(options, implementation_->rig, implementation_->scene);
  implementation_->settings.set_options(options);
}
LiveOptions LiveSession::live_options() const {
  LiveOptions live_options = implementation_->live_options;
  live_options.budget_ms = implementation_->settings.budget_ms();
  return live_options;
}
void LiveSession::set_budget_ms(double budget_ms) {
  implementation_->settings.set_budget_ms(budget_ms);
}
void LiveSession::forget() {
  implementation_->forget_wanted = true;
}
LiveStatus LiveSession::status() const {
  return implementation_->status();
}

std::shared_ptr<const LiveFrame> LiveSession::wait_for_frame(
    std::size_t after, std::chrono::milliseconds timeout) const {
  const Implementation& self = *implementation_;
  const auto end = std::chrono::steady_clock::now() + timeout;
  while (true) {
    const std::size_t seen = self.published.count();
    {
      const std::lock_guard lock(self.mutex);
      if (self.latest && self.latest->number > after) return self.latest;
    }
    const auto left = end - std::chrono::steady_clock::now();
    if (self.stopped || left.count() <= 0) return nullptr;
    self.published.wait(seen, left);
  }
}

std::shared_ptr<void> LiveSession::on_frame(
    std::function<void(const std::shared_ptr<const LiveFrame>&)> call) {
  return implementation_->listeners.add(std::move(call));
}

void LiveSession::stop() {
  implementation_->stop();
}

}  // namespace diminish
