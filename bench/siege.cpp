// Everything that can go wrong at once, for as long as one likes, while it must go on.
//   diminish_siege RECORDING FOLDER [MINUTES]    (by scripts/soak; recordings are made in FOLDER)
//
// - Every camera loses, repeats, tears, delays and shrinks images, stalls, and is unplugged.
// - 100 viewers read the page's stream slowly, or leave in the middle; others send nonsense.
// - Settings change every second: memory, backend, colours, inpainting, budget.
// - The session is recorded; every third recording meets a full disk. Each is then opened again.
//
// Prints a line a minute. Ends with 1 if the session stood still for ten seconds, a frame or a
// recording was lost to anything but a fault above, or memory, handles or threads stay behind.
#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <random>
#include <thread>
#include <vector>

#include "diminish/diminish.h"
#include "process_state.h"
#include "setup/repair/recording_repair.h"

namespace diminish {
namespace {

using std::chrono::milliseconds;

constexpr const char* faults =
    "faults:drop=0.02&duplicate=0.02&disorder=0.02&wrong_size=0.02&torn=0.02&stall=0.001&stall_s=2&"
    "unplug=0.002;";

/// A connection to the web server.
class Client {
 public:
  Client(int port, const std::string& request) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const timeval patience = {2, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_open_ = connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 &&
               send(socket_, request.data(), request.size(), MSG_NOSIGNAL) > 0;
  }
  ~Client() { close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// At most 16 kB; empty at the end.
  std::string read(int flags = 0) {
    std::array<char, 16384> buffer;  // NOLINT: recv fills it
    const auto count = is_open_ ? recv(socket_, buffer.data(), buffer.size(), flags) : 0;
    if (count == 0) is_open_ = false;
    return {buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
  }
  bool is_open() const { return is_open_; }

 private:
  int socket_;
  bool is_open_ = false;
};

std::string get(const std::string& path) {
  return "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n";
}
std::string post(const std::string& path, const std::string& body) {
  return fmt::format(
      "POST {} HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\n"
      "Content-Length: {}\r\nConnection: close\r\n\r\n{}",
      path, body.size(), body);
}

struct Counts {
  std::atomic<std::size_t> viewers = 0, refused = 0, answers = 0, no_answers = 0;
  std::size_t recordings = 0, full_disks = 0, lost_recordings = 0;
};

void view_slowly(int port, const std::atomic<bool>& ends, Counts& counts) {
  constexpr std::size_t viewers = 100;
  std::mt19937 random(1);
  std::vector<std::unique_ptr<Client>> clients(viewers);
  while (!ends) {
    for (auto& client : clients) {
      if (!client || !client->is_open() || random() % 500 == 0) {
        client = std::make_unique<Client>(port, get("/api/stream.mjpg?view=after"));
        ++counts.viewers;
      }
      if (client->read(MSG_DONTWAIT).starts_with("HTTP/1.1 503")) {
        ++counts.refused;
        client.reset();
      }
    }
    std::this_thread::sleep_for(milliseconds(100));
  }
}

void change_settings(int port, const std::atomic<bool>& ends, Counts& counts) {
  static const std::vector<std::string> requests = {
      post("/api/settings", R"({"memory": "off"})"),
      post("/api/settings", R"({"memory": "on"})"),
      post("/api/settings", R"({"memory": "witnessed"})"),
      post("/api/settings", R"({"backend": "gl"})"),
      post("/api/settings", R"({"backend": "cpu"})"),
      post("/api/settings", R"({"mode": "half", "on_doubt": "hold"})"),
      post("/api/settings", R"({"mode": "remove", "on_doubt": "pass-through"})"),
      post("/api/settings", R"({"inpaint": "surfaces"})"),
      post("/api/settings", R"({"inpaint": "structure", "budget_ms": 5})"),
      post("/api/settings", R"({"budget_ms": 0, "remove_shadows": true})"),
      post("/api/settings", R"({"remove_shadows": false})"),
      post("/api/settings", R"({"memory": ["nonsense"], "least_fit": 1e999})"),
      post("/api/memory", R"({"forget": true})"),
      get("/api/status"),
      get("/api/frame.png"),
      "GET / HTTP/9\r\n\xff\x01: \r\n\r\n\r\n",
      "POST /api/settings HTTP/1.1\r\nContent-Length: 99999999999999\r\n\r\n{"};
  std::mt19937 random(2);
  while (!ends) {
    const bool answered = !Client(port, requests[random() % requests.size()]).read().empty();
    ++(answered ? counts.answers : counts.no_answers);
    std::this_thread::sleep_for(milliseconds(1000));
  }
}

/// Files cannot grow beyond a few kB meanwhile, as on a full disk.
class FullDisk {
 public:
  FullDisk() {
    getrlimit(RLIMIT_FSIZE, &before_);
    constexpr rlim_t small = 8192;
    const rlimit limited = {small, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limited);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

void wait(double seconds, const std::atomic<bool>& ends) {
  const double end_s = monotonic_now_s() + seconds;
  while (!ends && monotonic_now_s() < end_s) std::this_thread::sleep_for(milliseconds(20));
}

/// Whether all that was recorded can be read.
bool is_whole(const std::filesystem::path& folder, std::size_t frames) {
  const RecordingRepair repair = repair_recording(folder);
  if (repair.was_needed()) return false;
  const auto source = open_recording(load_recording(folder), {});
  std::size_t read = 0;
  for (FrameSet frame; source->next(frame);) ++read;
  return read == frames;
}

void record(LiveSession& session, const Recording& recording, const std::filesystem::path& folder,
            const std::atomic<bool>& ends, Counts& counts) {
  constexpr double length_s = 15;
  while (!ends) {
    const std::filesystem::path here = folder / std::to_string(counts.recordings);
    RecordingWriter writer(here, recording.folder / "rig.yaml", recording.rig,
                           recording.folder / "scene.yaml", recording.scene);
    const auto listener = session.on_frame([&](const auto& frame) { writer.offer(frame); });
    wait(length_s, ends);
    if (counts.recordings % 3 == 2) {
      const FullDisk full;
      wait(2, ends);
    }
    writer.finish();
    const RecordingStatus status = writer.status();
    ++counts.recordings;
    if (!status.problem.empty()) ++counts.full_disks;
    if (status.frames > 0 && !is_whole(here, status.frames)) {
      ++counts.lost_recordings;
      std::printf("%s: not as it was written\n", here.c_str());
    } else {
      std::filesystem::remove_all(here);
    }
  }
}

int besiege(const Recording& recording, const std::filesystem::path& folder, double minutes) {
  std::vector<LiveCamera> cameras;
  const std::string replay = "recording:" + recording.folder.string() + "?loop";
  cameras.push_back({"color", faults + replay});
  for (const RgbdCamera& camera : recording.rig.rgbd) {
    cameras.push_back({camera.name, faults + replay + "&camera=" + camera.name});
  }
  const ProcessState before = ProcessState::now();
  auto session = std::make_unique<LiveSession>(recording.rig, recording.scene, Options{}, cameras,
                                               LiveOptions{});
  auto server = std::make_unique<WebServer>(*session, WebServerOptions{.port = 0});
  std::atomic<bool> ends = false;
  Counts counts;
  std::vector<std::thread> besiegers;
  besiegers.emplace_back([&] { view_slowly(server->port(), ends, counts); });
  besiegers.emplace_back([&] { change_settings(server->port(), ends, counts); });
  std::exception_ptr error;
  besiegers.emplace_back([&] {
    try {
      record(*session, recording, folder, ends, counts);
    } catch (...) {
      error = std::current_exception();
    }
  });

  std::printf("%6s %8s %8s %7s %7s %9s %9s %8s %8s\n", "minute", "frames", "skipped", "failed",
              "faults", "longest s", "MB", "handles", "threads");
  constexpr double longest_wait_s = 10;
  constexpr double minute_s = 60;
  const double start_s = monotonic_now_s();
  double last_frame_s = start_s;
  double longest_s = 0;
  std::size_t number = 0;
  int minute = 0;
  ProcessState early;
  while (minute < minutes) {
    if (const auto frame = session->wait_for_frame(number, milliseconds(500))) {
      number = frame->number;
      last_frame_s = monotonic_now_s();
    }
    const double now_s = monotonic_now_s();
    if (now_s - last_frame_s > longest_s + 1) {
      for (const std::string& problem : session->status().problems) {
        std::printf("no picture for %.0f s: %s\n", now_s - last_frame_s, problem.c_str());
      }
    }
    longest_s = std::max(longest_s, now_s - last_frame_s);
    if (now_s - start_s < minute_s * (minute + 1)) continue;
    ++minute;
    const LiveStatus status = session->status();
    std::size_t camera_faults = 0;
    for (const CameraStatus& camera : status.cameras) {
      camera_faults += camera.dropped + camera.duplicates + camera.out_of_order +
                       camera.wrong_size + camera.damaged + camera.stalls + camera.failures;
    }
    const ProcessState state = ProcessState::now();
    if (minute <= 2) early = state;
    std::printf("%6d %8zu %8zu %7zu %7zu %9.1f %9.0f %8ld %8ld\n", minute, status.frames,
                status.skipped, status.failed, camera_faults, longest_s, state.memory_mb,
                state.handles, state.threads);
    std::fflush(stdout);
  }
  ends = true;
  for (std::thread& besieger : besiegers) besieger.join();
  const double stop_s = monotonic_now_s();
  const std::size_t failed = session->status().failed;
  server.reset();
  session.reset();
  const double stopped_s = monotonic_now_s() - stop_s;
  if (error) std::rethrow_exception(error);

  const ProcessState after = ProcessState::now();
  std::printf(
      "%zu viewers came, %zu were told to come back; %zu requests answered, %zu not\n"
      "%zu recordings, %zu met a full disk, %zu could not be read as written\n"
      "longest time without a picture %.1f s; stopped in %.1f s\n"
      "handles %ld before, %ld after; threads %ld, %ld; memory %.0f MB early, %.0f MB after\n",
      counts.viewers.load(), counts.refused.load(), counts.answers.load(), counts.no_answers.load(),
      counts.recordings, counts.full_disks, counts.lost_recordings, longest_s, stopped_s,
      before.handles, after.handles, before.threads, after.threads, early.memory_mb,
      after.memory_mb);
  const bool held = longest_s < longest_wait_s && failed == 0 && counts.lost_recordings == 0 &&
                    stopped_s < longest_wait_s && counts.answers > 0;
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
                           argc > 3 ? std::stod(argv[3]) : 1);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
