// Everything that can go wrong at once, for as long as one likes, while it must go on.
//   diminish_siege RECORDING FOLDER [MINUTES]    (by scripts/soak; recordings are made in FOLDER)
//
// - Every camera loses, repeats, tears, delays and shrinks images, stalls, is unplugged, and has
// its
//   clock set back; RGB-D cameras come back with images of another size.
// - 100 viewers want the page's stream, of whom the server takes 16, who read slowly and leave in
//   the middle; the others must be told to come back. Others send nonsense.
// - Settings change every second: memory, backend, colours, inpainting, budget.
// - The driver loses the GPU's context; memory gets short.
// - The session is recorded; some recordings meet a full disk, some lose theirs. Each is then
// opened
//   again.
//
// Prints a line a minute. Ends with 1 if the session stood still for ten seconds, a frame or a
// recording was lost to anything but a fault above, a viewer was neither taken nor refused, or
// memory, handles or threads stay behind.
#include <fmt/format.h>
#include <malloc.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "diminish/diminish.h"
#include "hardships.h"
#include "process_state.h"
#include "setup/repair/recording_repair.h"
#include "sink/partial_file.h"
#include "web_client.h"

namespace diminish {
namespace {

using std::chrono::milliseconds;
using Flag = std::atomic<bool>;

constexpr const char* faults =
    "faults:drop=0.02&duplicate=0.02&disorder=0.02&wrong_size=0.02&torn=0.02&stall=0.001&stall_s=2&"
    "unplug=0.002&clock=0.001;";
constexpr const char* more_faults = "faults:resize=0.2;";
constexpr std::size_t most_viewers = 16;
/// The session may stand still for so long.
constexpr double longest_wait_s = 10;

struct Counts {
  std::atomic<std::size_t> viewers = 0, refused = 0, unanswered = 0, most_at_once = 0;
  std::atomic<std::size_t> answers = 0, no_answers = 0, short_memories = 0, failed_for_memory = 0;
  std::size_t recordings = 0, full_disks = 0, lost_disks = 0, lost_recordings = 0;
};

void wait(double seconds, const Flag& ends) {
  const double end_s = monotonic_now_s() + seconds;
  while (!ends && monotonic_now_s() < end_s) std::this_thread::sleep_for(milliseconds(20));
}

/// A page that shows the stream.
struct Viewer {
  std::unique_ptr<WebClient> client;
  double since_s = 0;
  bool is_answered = false, is_shown = false;

  void leave(Counts& counts) {
    if (client && !is_answered) ++counts.unanswered;
    client.reset();
    is_shown = false;
  }
};

void view_slowly(int port, const Flag& ends, Counts& counts) {
  constexpr std::size_t wanted = 100;
  std::mt19937 random(1);
  std::vector<Viewer> viewers(wanted);
  while (!ends) {
    std::size_t shown = 0;
    for (Viewer& viewer : viewers) {
      if (!viewer.client) {
        if (random() % 20 != 0) continue;
        viewer = {std::make_unique<WebClient>(port, get_request("/api/stream.mjpg?view=after")),
                  monotonic_now_s()};
        ++counts.viewers;
      }
      const std::string read = viewer.client->read(MSG_DONTWAIT);
      viewer.is_answered |= !read.empty();
      if (read.starts_with("HTTP/1.1 503")) {
        ++counts.refused;
        viewer.leave(counts);
        continue;
      }
      viewer.is_shown |= !read.empty();
      shown += viewer.is_shown ? 1 : 0;
      const bool has_waited =
          viewer.is_answered || monotonic_now_s() - viewer.since_s > longest_wait_s;
      if (!viewer.client->is_open() || (has_waited && random() % 500 == 0)) viewer.leave(counts);
    }
    if (shown > counts.most_at_once) counts.most_at_once = shown;
    std::this_thread::sleep_for(milliseconds(100));
  }
}

void change_settings(int port, const Flag& ends, Counts& counts) {
  static const std::vector<std::string> requests = {
      post_request("/api/settings", R"({"memory": "off"})"),
      post_request("/api/settings", R"({"memory": "on"})"),
      post_request("/api/settings", R"({"memory": "witnessed"})"),
      post_request("/api/settings", R"({"backend": "gl"})"),
      post_request("/api/settings", R"({"backend": "cpu"})"),
      post_request("/api/settings", R"({"mode": "half", "on_doubt": "hold"})"),
      post_request("/api/settings", R"({"mode": "remove", "on_doubt": "pass-through"})"),
      post_request("/api/settings", R"({"inpaint": "surfaces"})"),
      post_request("/api/settings", R"({"inpaint": "structure", "budget_ms": 5})"),
      post_request("/api/settings", R"({"budget_ms": 0, "remove_shadows": true})"),
      post_request("/api/settings", R"({"remove_shadows": false})"),
      post_request("/api/settings", R"({"memory": ["nonsense"], "least_fit": 1e999})"),
      post_request("/api/memory", R"({"forget": true})"),
      get_request("/api/status"),
      get_request("/api/frame.png"),
      "GET / HTTP/9\r\n\xff\x01: \r\n\r\n\r\n",
      "POST /api/settings HTTP/1.1\r\nContent-Length: 99999999999999\r\n\r\n{"};
  std::mt19937 random(2);
  while (!ends) {
    const bool answered = !WebClient(port, requests[random() % requests.size()]).read().empty();
    ++(answered ? counts.answers : counts.no_answers);
    wait(1, ends);
  }
}

/// Now and then there is no memory for more. Only with the CPU: drivers give up then.
void shorten_memory(LiveSession& session, const Flag& ends, Counts& counts) {
  constexpr double every_s = 30;
  while (!ends) {
    wait(every_s, ends);
    if (session.options().backend != "cpu") continue;
    const std::size_t failed = session.status().failed;
    {
      const LittleMemory little;
      std::this_thread::sleep_for(milliseconds(500));
    }
    wait(2, ends);
    counts.failed_for_memory += session.status().failed - failed;
    ++counts.short_memories;
  }
}

/// Whether all that was recorded can be read. was_lost: the folder, perhaps in the middle of a
/// file, which then has a name that says so.
bool is_whole(const std::filesystem::path& folder, std::size_t frames, bool was_lost) {
  RecordingRepair repair = repair_recording(folder);
  if (was_lost) std::erase_if(repair.deleted, is_partial_file);
  if (repair.was_needed()) return false;
  const auto source = open_recording(load_recording(folder), {});
  std::size_t read = 0;
  for (FrameSet frame; source->next(frame);) ++read;
  return read == frames;
}

void record(LiveSession& session, const Recording& recording, const std::filesystem::path& folder,
            const Flag& ends, Counts& counts) {
  constexpr double length_s = 15;
  while (!ends) {
    const std::filesystem::path here = folder / std::to_string(counts.recordings);
    RecordingWriter writer(here, recording.folder / "rig.yaml", recording.rig,
                           recording.folder / "scene.yaml", recording.scene);
    const auto listener = session.on_frame([&](const auto& frame) { writer.offer(frame); });
    wait(length_s, ends);
    const std::size_t kind = counts.recordings++ % 4;
    if (kind == 2) {
      const FullDisk full;
      wait(2, ends);
      writer.finish();
      if (!writer.status().problem.empty()) ++counts.full_disks;
    } else if (kind == 3) {
      const LostFolder lost(here);
      wait(2, ends);
      writer.finish();
      if (!writer.status().problem.empty()) ++counts.lost_disks;
    }
    writer.finish();
    const RecordingStatus status = writer.status();
    if (kind < 2 && !status.problem.empty()) std::printf("recording: %s\n", status.problem.c_str());
    if (status.frames > 0 && !is_whole(here, status.frames, kind == 3)) {
      ++counts.lost_recordings;
      std::printf("%s: not as it was written\n", here.c_str());
    } else {
      std::filesystem::remove_all(here);
    }
  }
}

/// A session with its page, besieged from all sides.
class Siege {
 public:
  Siege(const Recording& recording, const std::filesystem::path& folder) {
    std::vector<LiveCamera> cameras;
    const std::string replay = "recording:" + recording.folder.string() + "?loop";
    cameras.push_back({"color", faults + replay});
    for (const RgbdCamera& camera : recording.rig.rgbd) {
      cameras.push_back({camera.name, faults + (more_faults + replay) + "&camera=" + camera.name});
    }
    session_ = std::make_unique<LiveSession>(recording.rig, recording.scene, Options{}, cameras,
                                             LiveOptions{});
    server_ = std::make_unique<WebServer>(
        *session_, WebServerOptions{.port = 0, .most_viewers = most_viewers});
    const auto begin = [this](auto work) {
      besiegers_.emplace_back([this, work] {
        try {
          work();
        } catch (...) {
          const std::lock_guard lock(mutex_);
          error_ = std::current_exception();
        }
      });
    };
    begin([this] { view_slowly(server_->port(), ends_, counts_); });
    begin([this] { change_settings(server_->port(), ends_, counts_); });
    begin([this] { shorten_memory(*session_, ends_, counts_); });
    begin([this, &recording, folder] { record(*session_, recording, folder, ends_, counts_); });
  }
  ~Siege() { end(); }
  Siege(const Siege&) = delete;
  Siege& operator=(const Siege&) = delete;

  /// Notes how long there was no picture.
  void watch(double seconds) {
    const double end_s = monotonic_now_s() + seconds;
    double last_frame_s = monotonic_now_s();
    while (monotonic_now_s() < end_s) {
      if (const auto frame = session_->wait_for_frame(number_, milliseconds(500))) {
        number_ = frame->number;
        last_frame_s = monotonic_now_s();
      }
      const double without_s = monotonic_now_s() - last_frame_s;
      if (without_s > longest_s_ + 1) {
        for (const std::string& problem : session_->status().problems) {
          std::printf("no picture for %.0f s: %s\n", without_s, problem.c_str());
        }
      }
      longest_s_ = std::max(longest_s_, without_s);
    }
  }

  void end() {
    ends_ = true;
    for (std::thread& besieger : besiegers_) besieger.join();
    besiegers_.clear();
    if (!session_) return;
    const double stop_s = monotonic_now_s();
    failed_ = session_->status().failed;
    server_.reset();
    session_.reset();
    stopped_s_ = monotonic_now_s() - stop_s;
  }
  /// Throws what ended a besieger, if anything did.
  void check() const {
    if (error_) std::rethrow_exception(error_);
  }

  LiveStatus status() const { return session_->status(); }
  const Counts& counts() const { return counts_; }
  double longest_s() const { return longest_s_; }

  /// Whether it held, after its end.
  bool held() const {
    return longest_s_ < longest_wait_s && stopped_s_ < longest_wait_s &&
           failed_ == counts_.failed_for_memory && counts_.lost_recordings == 0 &&
           counts_.answers > 0 && counts_.refused > 0 && counts_.unanswered == 0 &&
           counts_.most_at_once > most_viewers / 2;
  }
  void print() const {
    std::printf(
        "%zu viewers came, %zu at most were shown pictures at once, %zu told to come back, %zu not "
        "answered\n%zu requests answered, %zu not\n"
        "%zu recordings, %zu met a full disk, %zu lost theirs, %zu could not be read as written\n"
        "%zu times the driver lost the context, %zu times memory was short: %zu of %zu failed "
        "frames\n"
        "longest time without a picture %.1f s; stopped in %.1f s\n",
        counts_.viewers.load(), counts_.most_at_once.load(), counts_.refused.load(),
        counts_.unanswered.load(), counts_.answers.load(), counts_.no_answers.load(),
        counts_.recordings, counts_.full_disks, counts_.lost_disks, counts_.lost_recordings,
        LosingDriver::lost.load(), counts_.short_memories.load(), counts_.failed_for_memory.load(),
        failed_, longest_s_, stopped_s_);
  }

 private:
  Flag ends_ = false;
  Counts counts_;
  std::unique_ptr<LiveSession> session_;
  std::unique_ptr<WebServer> server_;
  std::vector<std::thread> besiegers_;
  std::mutex mutex_;
  std::exception_ptr error_;
  std::size_t number_ = 0, failed_ = 0;
  double longest_s_ = 0, stopped_s_ = 0;
};

std::size_t camera_faults(const LiveStatus& status) {
  std::size_t count = 0;
  for (const CameraStatus& camera : status.cameras) {
    count += camera.dropped + camera.duplicates + camera.out_of_order + camera.wrong_size +
             camera.damaged + camera.stalls + camera.failures;
  }
  return count;
}

/// Without what the allocator keeps for later.
ProcessState state_in_use() {
  malloc_trim(0);
  return ProcessState::now();
}

/// Those of which there are more than there were.
void print_new_threads(const std::map<std::string, long>& before) {
  for (const auto& [name, count] : ProcessState::thread_names()) {
    const auto found = before.find(name);
    const long was = found == before.end() ? 0 : found->second;
    if (count > was)
      std::printf("threads called %s: %ld before, %ld now\n", name.c_str(), was, count);
  }
}

int besiege(const Recording& recording, const std::filesystem::path& folder, int minutes) {
  constexpr double minute_s = 60;
  const LosingDriver driver;
  // What libraries keep for good, a first session leaves behind.
  {
    Siege first(recording, folder);
    first.watch(minute_s / 2);
    first.end();
    first.check();
  }
  const ProcessState before = state_in_use();
  const auto threads_before = ProcessState::thread_names();
  Siege siege(recording, folder);
  std::printf("%6s %8s %8s %7s %7s %9s %9s %8s %8s\n", "minute", "frames", "skipped", "failed",
              "faults", "longest s", "MB", "handles", "threads");
  for (int minute = 1; minute <= minutes; ++minute) {
    siege.watch(minute_s);
    const LiveStatus status = siege.status();
    const ProcessState state = ProcessState::now();
    std::printf("%6d %8zu %8zu %7zu %7zu %9.1f %9.0f %8ld %8ld\n", minute, status.frames,
                status.skipped, status.failed, camera_faults(status), siege.longest_s(),
                state.memory_mb, state.handles, state.threads);
    std::fflush(stdout);
  }
  siege.end();
  siege.check();
  siege.print();
  const ProcessState after = state_in_use();
  std::printf(
      "after a first session, and at the end: %.0f and %.0f MB, %ld and %ld handles, %ld and "
      "%ld threads\n",
      before.memory_mb, after.memory_mb, before.handles, after.handles, before.threads,
      after.threads);
  print_new_threads(threads_before);
  constexpr double steady_memory = 1.25;
  const bool held = siege.held() && after.memory_mb <= steady_memory * before.memory_mb &&
                    after.handles <= before.handles && after.threads <= before.threads;
  std::puts(held ? "held" : "did NOT hold");
  return held ? 0 : 1;
}

}  // namespace
}  // namespace diminish

int main(int argc, char** argv) try {
  if (argc < 3 || argc > 4) {
    std::fprintf(stderr, "usage: diminish_siege RECORDING FOLDER [MINUTES]\n");
    return 2;
  }
  std::signal(SIGXFSZ, SIG_IGN);
  std::filesystem::create_directories(argv[2]);
  return diminish::besiege(diminish::load_recording(argv[1]), argv[2],
                           argc > 3 ? std::stoi(argv[3]) : 1);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
