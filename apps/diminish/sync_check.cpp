#include <fmt/format.h>

#include <exception>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "commands.h"
#include "live/motion_signal.h"
#include "live_setup.h"

namespace diminish {
namespace {

constexpr int some_not_known = 3;

struct SyncCheckCommand {
  LiveSetup setup;
  double seconds = 10;

  int execute() const;
};

/// What a camera's thread found.
struct Watched {
  std::string name;
  std::vector<MotionSample> motion;
  std::string problem;
};

Watched watch(const LiveCamera& camera, const CameraRequest& request, double end_s) {
  Watched watched{.name = camera.name, .motion = {}, .problem = {}};
  try {
    const auto source = open_camera(camera.uri, request);
    MotionMeter meter;
    CameraImage image;
    while (monotonic_now_s() < end_s && !stop_requested()) {
      const auto status = source->read(image, std::chrono::milliseconds(100));
      if (status == CameraSource::Status::end) break;
      const bool is_usable = status == CameraSource::Status::image &&
                             image.sensor == Sensor::color && image.fault.empty();
      if (!is_usable) continue;
      if (const auto motion = meter.add(image.color, image.stamp_s)) {
        watched.motion.push_back(*motion);
      }
    }
  } catch (const std::exception& error) {
    watched.problem = error.what();
  }
  return watched;
}

double frame_period_s(const std::vector<MotionSample>& motion) {
  if (motion.size() < 2) return 1.0 / 30;
  return (motion.back().stamp_s - motion.front().stamp_s) / static_cast<double>(motion.size() - 1);
}

int SyncCheckCommand::execute() const {
  stop_on_signals();
  const Rig rig = load_rig(setup.rig_file());
  const std::vector<LiveCamera> cameras = setup.cameras(rig);
  const double epoch_s = monotonic_now_s();
  std::vector<Watched> watched(cameras.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    threads.emplace_back([&, i] {
      watched[i] = watch(cameras[i], {cameras[i].name, &rig, epoch_s}, epoch_s + seconds);
    });
  }
  for (std::thread& thread : threads) thread.join();

  const Watched& color = watched.front();
  const double half_frame_s = frame_period_s(color.motion) / 2;
  int exit_code = 0;
  for (const Watched& camera : watched) {
    if (!camera.problem.empty()) {
      fmt::print("{:<10} {}\n", camera.name, camera.problem);
      exit_code = some_not_known;
    }
    if (&camera == &color || !camera.problem.empty() || camera.motion.empty()) continue;
    const auto offset = estimate_sync_offset(color.motion, camera.motion);
    if (!offset) {
      fmt::print("{:<10} unknown: both cameras saw too little motion; wave something\n",
                 camera.name);
      exit_code = some_not_known;
      continue;
    }
    const bool is_large = std::abs(offset->offset_s) > half_frame_s;
    fmt::print("{:<10} {:+.1f} ms relative to color (correlation {:.2f}){}\n", camera.name,
               1000 * offset->offset_s, offset->correlation,
               is_large
                   ? fmt::format(": more than half a frame ({:.1f} ms), so it shows another moment",
                                 1000 * half_frame_s)
                   : "");
    if (is_large) exit_code = some_not_known;
  }
  return exit_code;
}

}  // namespace

void add_sync_check(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<SyncCheckCommand>();
  CLI::App* sub = program.add_subcommand(
      "sync-check",
      "Measures how far apart the cameras' clocks are, from what moves in their pictures");
  command->setup.add_flags(*sub);
  sub->add_option("--seconds", command->seconds, "Duration")
      ->capture_default_str()
      ->check(CLI::Range(4.0, 3600.0))
      ->type_name("S");
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
