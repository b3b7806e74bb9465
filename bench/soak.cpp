// Whether frames cost at the end what they cost at the start.
//   diminish_soak RECORDING [FRAMES [MEMORY [SHRINKAGE]]]    (by scripts/soak; MEMORY: as --memory;
//                                                             SHRINKAGE: of all images' sides)
//
// The recording is played forwards and backwards, at 30 frames a second of its own time, as fast
// as the machine can. It should find its poses by markers: poses from files end with them. Prints
// 24 stretches of the frames; ends with 1 if memory, handles or threads grow from the third on,
// or if a frame takes a fifth more CPU time in the last two than in the third and fourth. Stopped
// by ctrl-C or SIGTERM, it judges what ran until then, and ends with 1 or 3.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <exception>
#include <optional>
#include <vector>

#include "core/shrink.h"
#include "diminish/diminish.h"
#include "geometry/shrunk_camera.h"
#include "process_state.h"

namespace diminish {
namespace {

constexpr std::size_t stretches = 24;
constexpr double frames_per_second = 30;
volatile std::sig_atomic_t is_stopped = 0;

struct Stretch {
  std::size_t end = 0;  ///< frames until then
  ProcessState state;
  double cpu_ms = 0;  ///< of all threads, a frame: other programs do not slow it
  double median_ms = 0, p99_ms = 0;
};

double cpu_ms() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

double quantile(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

Rig shrunk_rig(Rig rig, int by) {
  rig.color = shrunk_camera(rig.color, by);
  for (RgbdCamera& camera : rig.rgbd) {
    camera.color = shrunk_camera(camera.color, by);
    camera.depth = shrunk_camera(camera.depth, by);
  }
  return rig;
}

void shrink_picture(InputImage<Bgr>& picture, int by) {
  if (picture.empty()) return;
  Image<Bgr> small;
  const Rect whole = shrunk_bounds(picture, by);
  small.resize(whole.width, whole.height);
  std::vector<std::uint16_t> scratch;
  shrink(picture, by, whole, scratch, small);
  picture.own() = std::move(small);
}

/// Depths are not averaged: those across an edge would lie on nothing.
void shrink_depth(InputImage<std::uint16_t>& depth, int by) {
  if (depth.empty()) return;
  Image<std::uint16_t> small(depth.width() / by, depth.height() / by);
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width(); ++x) {
      small.row(y)[x] = depth.row(by * y + by / 2)[by * x + by / 2];
    }
  }
  depth.own() = std::move(small);
}

/// Plays frames there and back.
class Player {
 public:
  Player(const Recording& recording, const Options& options, int shrinkage)
      : pipeline_(shrunk_rig(recording.rig, shrinkage), recording.scene, options) {
    const auto source = open_recording(recording, options);
    for (FrameSet frame; source->next(frame);) {
      shrink_picture(frame.color, shrinkage);
      for (RgbdFrame& camera : frame.rgbd) {
        shrink_picture(camera.color, shrinkage);
        shrink_depth(camera.depth, shrinkage);
      }
      frames_.push_back(frame);
    }
    if (frames_.size() < 2) throw Error("expected a recording of two frames or more");
    pipeline_.want_reconstruction(false);
  }

  double next_ms() {
    const std::size_t lap = 2 * frames_.size() - 2;
    const std::size_t place = played_ % lap;
    FrameSet& frame = frames_[place < frames_.size() ? place : lap - place];
    // Each image as old as it was when it was recorded
    const double later_s = static_cast<double>(played_++) / frames_per_second - frame.stamp_s;
    frame.stamp_s += later_s;
    for (RgbdFrame& camera : frame.rgbd) {
      camera.color_stamp_s += later_s;
      camera.depth_stamp_s += later_s;
    }
    const auto start = std::chrono::steady_clock::now();
    pipeline_.process(frame, result_);
    if (result_.report.mask_pixels > 0) ++with_object_;
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
  }
  std::size_t with_object() const { return with_object_; }

 private:
  Pipeline pipeline_;
  std::vector<FrameSet> frames_;
  DiminishedFrame result_;
  std::size_t played_ = 0;
  std::size_t with_object_ = 0;
};

/// Prints it. A stretch that was stopped as it began tells nothing.
void add(std::size_t end, double begun_ms, std::vector<double>& times_ms,
         std::vector<Stretch>& done) {
  constexpr std::size_t fewest_frames = 40;
  if (times_ms.size() < fewest_frames) return;
  const Stretch& stretch = done.emplace_back(Stretch{
      end, ProcessState::now(), (cpu_ms() - begun_ms) / static_cast<double>(times_ms.size()),
      quantile(times_ms, 0.5), quantile(times_ms, 0.99)});
  std::printf("%10zu %10.2f %10.2f %10.2f %10.1f %9ld %9ld\n", end, stretch.cpu_ms,
              stretch.median_ms, stretch.p99_ms, stretch.state.memory_mb, stretch.state.handles,
              stretch.state.threads);
  std::fflush(stdout);
}

/// Whether it is the same at the end as at the start; nothing of too few stretches.
std::optional<bool> is_steady(const std::vector<Stretch>& done) {
  constexpr std::size_t fewest = 6;
  if (done.size() < fewest) {
    std::printf("too short to judge: %zu of %zu stretches\n", done.size(), stretches);
    return std::nullopt;
  }
  const Stretch& start = done[2];
  const Stretch& end = done.back();
  const double start_ms = done[2].cpu_ms + done[3].cpu_ms;
  const double end_ms = done[done.size() - 2].cpu_ms + end.cpu_ms;
  constexpr double steady_memory = 1.01;
  constexpr double steady_time = 1.2;
  std::printf("frames %zu to %zu: CPU time x %.3f, memory x %.4f\n", start.end, end.end,
              end_ms / start_ms, end.state.memory_mb / start.state.memory_mb);
  return end.state.memory_mb <= steady_memory * start.state.memory_mb &&
         end.state.handles <= start.state.handles && end.state.threads <= start.state.threads &&
         end_ms <= steady_time * start_ms;
}

/// Returns whether it is the same at the end as at the start, if that can be told.
std::optional<bool> soak(const Recording& recording, std::size_t frames, const Options& options,
                         int shrinkage) {
  Player player(recording, options, shrinkage);
  std::printf("%zu frames, %.1f hours at %.0f frames a second, %d pixels wide; memory %s\n", frames,
              static_cast<double>(frames) / frames_per_second / 3600, frames_per_second,
              recording.rig.color.width / shrinkage, options.memory.c_str());
  std::printf("%10s %10s %10s %10s %10s %9s %9s\n", "frames", "CPU ms", "median ms", "99 % ms",
              "MB", "handles", "threads");
  std::vector<Stretch> done;
  std::vector<double> times_ms;
  times_ms.reserve(frames / stretches + 1);
  std::size_t played = 0;
  for (std::size_t k = 0; k < stretches && is_stopped == 0; ++k) {
    times_ms.clear();
    const double begun_ms = cpu_ms();
    const std::size_t end = frames * (k + 1) / stretches;
    for (; played < end && is_stopped == 0; ++played) times_ms.push_back(player.next_ms());
    add(played, begun_ms, times_ms, done);
  }
  if (is_stopped != 0) std::printf("stopped after %zu of %zu frames\n", played, frames);
  std::printf("an object in %zu frames\n", player.with_object());
  return is_steady(done);
}

}  // namespace
}  // namespace diminish

int main(int argc, char** argv) try {
  constexpr std::size_t hour = std::size_t{30} * 3600;
  const std::size_t frames = argc > 2 ? std::stoul(argv[2]) : hour;
  const int shrinkage = argc > 4 ? std::stoi(argv[4]) : 1;
  if (argc < 2 || argc > 5 || frames < 1000 || shrinkage < 1 || shrinkage > 16) {
    std::fprintf(stderr,
                 "usage: diminish_soak RECORDING [FRAMES (1000 or more) [MEMORY [SHRINKAGE]]]\n");
    return 2;
  }
  diminish::Options options;
  if (argc > 3) options.memory = argv[3];
  for (const int signal : {SIGINT, SIGTERM}) {
    std::signal(signal, [](int) { diminish::is_stopped = 1; });
  }
  const std::optional<bool> is_steady =
      diminish::soak(diminish::load_recording(argv[1]), frames, options, shrinkage);
  if (is_steady) std::puts(*is_steady ? "steady" : "NOT steady");
  if (is_steady && !*is_steady) return 1;
  return diminish::is_stopped == 0 ? 0 : 3;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
