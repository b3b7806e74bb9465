#include <fmt/format.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <thread>

#include "diminish/error.h"
#include "diminish/live.h"
#include "diminish/pipeline.h"
#include "live/camera_feed.h"
#include "live/frame_assembler.h"
#include "live/pool.h"
#include "live/quality_ladder.h"
#include "sink/distribution.h"
#include "sink/shares.h"
#include "source/find_camera.h"

namespace diminish {
namespace {

constexpr std::size_t window_frames = 150;
/// Without a picture for this long, the status says so.
constexpr double no_picture_after_s = 1;

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
        options(options_),
        live_options(live_options_),
        pipeline(rig, scene, options),
        assembler{make_inboxes(), rgbd_inboxes()} {  // braces: evaluated from left to right
    check_cameras(rig, cameras);
    pipeline.want_reconstruction(false);
    if (live_options.background) pipeline.set_background(*live_options.background);
    last_good_options = options;
    const double epoch_s = monotonic_now_s();
    for (const LiveCamera& camera : cameras) {
      CameraInbox& inbox = **std::find_if(inboxes.begin(), inboxes.end(), [&](const auto& box) {
        return box->name() == camera.name;
      });
      feeds.push_back(std::make_unique<CameraFeed>(
          camera, CameraRequest{camera.name, &rig, epoch_s}, inbox, arrived));
    }
    worker = std::thread([this] { work(); });
  }

  ~Implementation() { stop(); }

  CameraInbox& make_inboxes() {
    inboxes.push_back(std::make_unique<CameraInbox>("color", rig.color, std::nullopt));
    for (const RgbdCamera& camera : rig.rgbd) {
      inboxes.push_back(std::make_unique<CameraInbox>(camera.name, camera.color, camera.depth));
    }
    return *inboxes.front();
  }
  std::vector<CameraInbox*> rgbd_inboxes() const {
    std::vector<CameraInbox*> rgbd;
    for (std::size_t i = 1; i < inboxes.size(); ++i) rgbd.push_back(inboxes[i].get());
    return rgbd;
  }

  void stop() {
    stopped = true;
    arrived.notify();
    published.notify();
    for (const auto& feed : feeds) feed->stop();
    if (worker.joinable()) worker.join();
  }

  void work() {
    const int threads =
        live_options.threads > 0 ? live_options.threads : oneapi::tbb::task_arena::automatic;
    oneapi::tbb::task_arena arena(threads);
    std::shared_ptr<LiveFrame> frame = pool.take();
    while (!stopped) {
      const std::size_t seen = arrived.count();
      try {
        if (!make_frame(*frame)) {
          const auto deadline_s = assembler.next_deadline_s(sync_settings());
          if (!deadline_s) nothing_new_at = seen;
          arrived.wait(seen, waiting_time(deadline_s));
          continue;
        }
        apply_options();
        if (forget_wanted.exchange(false)) pipeline.forget();
        arena.execute([&] { pipeline.process(frame->input, frame->result); });
        publish(frame);
        frame = pool.take();
      } catch (const std::exception& error) {
        note_failure(error.what());
      } catch (...) {
        note_failure("an unknown error");
      }
    }
  }

  FrameAssembler::Settings sync_settings() const {
    const std::lock_guard lock(mutex);
    return {options.sync_tolerance_s, live_options.sync_wait_s};
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

  void apply_options() {
    const std::lock_guard lock(mutex);
    if (!options_changed) return;
    options_changed = false;
    try {
      pipeline.set_options(QualityLadder::simplified(options, ladder.level()));
    } catch (const Error& error) {  // a backend that does not work here
      settings_problem = error.what();
      options = last_good_options;
      pipeline.set_options(QualityLadder::simplified(options, ladder.level()));
    }
    last_good_options = options;
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
      const int level = ladder.level();
      const double frame_ms = frame->result.report.frame_ms;
      if (ladder.next_level(frame_ms, live_options.budget_ms, options) != level) {
        options_changed = true;
      }
      failure.clear();
    }
    const std::lock_guard lock(listeners_mutex);
    std::erase_if(listeners, [](const auto& listener) { return listener.expired(); });
    for (const auto& weak : listeners) {
      if (const auto listener = weak.lock()) (*listener)(frame);
    }
    published.notify();
  }

  void note_failure(const std::string& what) {
    const std::lock_guard lock(mutex);
    ++failed;
    failure = what;
  }

  LiveStatus status() const;
  void describe_cameras(LiveStatus& status, double now_s) const;

  using Listener = std::function<void(const std::shared_ptr<const LiveFrame>&)>;

  const Rig rig;
  const Scene scene;
  mutable std::mutex mutex;  ///< guards the members up to the next blank line
  Options options;
  LiveOptions live_options;
  QualityLadder ladder;
  std::shared_ptr<const LiveFrame> latest;
  SlidingWindow latencies_ms{window_frames};
  SlidingWindow publish_times_s{window_frames};
  std::size_t skipped = 0, failed = 0;
  std::string failure, settings_problem;
  Options last_good_options;
  bool options_changed = true;

  Pipeline pipeline;
  Pool<LiveFrame> pool;
  std::vector<std::unique_ptr<CameraInbox>> inboxes;  ///< "color" and each RGB-D camera's
  FrameAssembler assembler;
  ArrivalSignal arrived, published;
  std::mutex listeners_mutex;
  std::vector<std::weak_ptr<Listener>> listeners;
  std::atomic<bool> stopped = false, forget_wanted = false;
  std::atomic<std::size_t> nothing_new_at =
      0;  ///< the count of `arrived` up to which everything is shown
  std::vector<std::unique_ptr<CameraFeed>> feeds;
  std::thread worker;
};

void LiveSession::Implementation::describe_cameras(LiveStatus& status, double now_s) const {
  for (const auto& feed : feeds) status.cameras.push_back(feed->status());
  for (const CameraStatus& camera : status.cameras) {
    if (camera.state == CameraState::lost) {
      status.problems.push_back(camera.name + ": camera lost: " + camera.problem);
    } else if (camera.state == CameraState::silent) {
      status.problems.push_back(camera.name + ": the camera is silent: " + camera.problem);
    } else if (camera.state == CameraState::ended && camera.name == "color") {
      status.ended = nothing_new_at == arrived.count();
    }
  }
  if (!status.ended && (!latest || now_s - latest->published_s > no_picture_after_s)) {
    status.problems.push_back("no new picture");
  }
}

LiveStatus LiveSession::Implementation::status() const {
  LiveStatus status;
  status.running = !stopped;
  const std::lock_guard lock(mutex);
  describe_cameras(status, monotonic_now_s());
  status.skipped = skipped;
  status.failed = failed;
  status.frames_per_second = publish_times_s.rate();
  const Distribution latency = distribution_of(latencies_ms.values());
  status.latency_ms = {latency.p50, latency.p95, latency.p99};
  status.budget_ms = live_options.budget_ms;
  status.quality_level = ladder.level();
  status.quality = QualityLadder::description(options, ladder.level());
  if (!settings_problem.empty()) status.problems.push_back(settings_problem);
  if (!failure.empty()) status.problems.push_back("the last frame failed: " + failure);
  if (!latest) return status;
  const FrameReport& report = latest->result.report;
  status.frames = latest->number;
  status.stage_ms = report.milliseconds;
  status.frame_ms = report.frame_ms;
  for (const auto& pose : report.poses.color_from_depth) status.posed.push_back(pose.has_value());
  status.markers.push_back(report.markers.color.size());
  for (const auto& markers : report.markers.rgbd) status.markers.push_back(markers.size());
  status.occluders = report.occluders;
  const double pixels = static_cast<double>(latest->result.mask.size());
  if (pixels > 0) status.mask_share = static_cast<double>(report.mask_pixels) / pixels;
  const Shares shares = shares_of(report.mask_pixels, report.valid_pixels, report.witnessed_pixels,
                                  report.remembered_pixels);
  status.seen_share = shares.seen;
  status.witnessed_share = shares.witnessed;
  status.remembered_share = shares.remembered;
  status.invented_share = shares.invented;
  status.evidence = to_text(shares);
  status.memory = report.memory;
  for (const std::string& message : report.messages) {
    const bool is_said =
        std::any_of(status.cameras.begin(), status.cameras.end(), [&](const auto& c) {
          return c.state != CameraState::running && message.starts_with(c.name + ":");
        });
    if (!is_said) status.problems.push_back(message);
  }
  return status;
}

LiveSession::LiveSession(const Rig& rig, const Scene& scene, const Options& options,
                         const std::vector<LiveCamera>& cameras, const LiveOptions& live_options)
    : implementation_(
          std::make_unique<Implementation>(rig, scene, options, cameras, live_options)) {}
LiveSession::~LiveSession() = default;

const Rig& LiveSession::rig() const {
  return implementation_->rig;
}
const Scene& LiveSession::scene() const {
  return implementation_->scene;
}
Options LiveSession::options() const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->options;
}
void LiveSession::set_options(const Options& options) {
  check(options, implementation_->rig, implementation_->scene);
  const std::lock_guard lock(implementation_->mutex);
  implementation_->options = options;
  implementation_->options_changed = true;
  implementation_->settings_problem.clear();
}
LiveOptions LiveSession::live_options() const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->live_options;
}
void LiveSession::set_budget_ms(double budget_ms) {
  const std::lock_guard lock(implementation_->mutex);
  implementation_->live_options.budget_ms = budget_ms;
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
  auto listener = std::make_shared<Implementation::Listener>(std::move(call));
  const std::lock_guard lock(implementation_->listeners_mutex);
  implementation_->listeners.push_back(listener);
  return listener;
}

void LiveSession::stop() {
  implementation_->stop();
}

}  // namespace diminish
