#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>

#include "commands.h"
#include "live_setup.h"

namespace diminish {
namespace {

struct LiveCommand {
  LiveSetup setup;
  double seconds = 0;

  int execute() const;
};

void print_line(const LiveStatus& status) {
  fmt::print("{:>7} frames  {:>5.1f} frames/s  {:>6.1f} ms per frame  latency {:.0f} ms",
             status.frames, status.frames_per_second, status.frame_ms, status.latency_ms.p50);
  if (status.quality_level > 0) fmt::print("  quality level {}", status.quality_level);
  for (const std::string& problem : status.problems) fmt::print("  [{}]", problem);
  fmt::print("\n");
  std::fflush(stdout);
}

void print_remote(const std::string& name, const RemoteStatus& remote) {
  const double frames = static_cast<double>(std::max<std::size_t>(remote.frames, 1));
  fmt::print(
      "{}: asked about {} frames, {} glances came; {} contributions asked for, {} came, after "
      "{:.1f} ms, {:.1f} of them on the way; {:.1f} kB a frame came, {:.1f} kB went, at a cost "
      "here "
      "of {:.2f} ms\n",
      name, remote.frames, remote.glances, remote.asked_layers, remote.layers, remote.layer_ms,
      remote.way_ms, static_cast<double>(remote.bytes_received) / 1e3 / frames,
      static_cast<double>(remote.bytes_sent) / 1e3 / frames, remote.own_ms);
}

void print_summary(const LiveStatus& status, const LiveRun& run) {
  fmt::print("\n{} frames, {} colour images skipped for newer ones, {} frames failed\n",
             status.frames, status.skipped, status.failed);
  fmt::print("Latency: p50 {:.1f}, p95 {:.1f}, p99 {:.1f} ms\n", status.latency_ms.p50,
             status.latency_ms.p95, status.latency_ms.p99);
  fmt::print("{:<10}{:>9}{:>8}{:>11}{:>13}{:>12}{:>9}{:>8}{:>10}{:>12}\n", "camera", "images",
             "dropped", "duplicates", "out of order", "wrong size", "damaged", "stalls", "failures",
             "reconnects");
  for (const CameraStatus& camera : status.cameras) {
    fmt::print("{:<10}{:>9}{:>8}{:>11}{:>13}{:>12}{:>9}{:>8}{:>10}{:>12}\n", camera.name,
               camera.images, camera.dropped, camera.duplicates, camera.out_of_order,
               camera.wrong_size, camera.damaged, camera.stalls, camera.failures,
               camera.reconnects);
  }
  for (const CameraStatus& camera : status.cameras) {
    if (!camera.clock) continue;
    fmt::print("{}: its clock is {:+.1f} ms off, and gains {:+.1f} ppm ({})\n", camera.name,
               camera.clock->offset_s * 1e3, camera.clock->drift * 1e6,
               camera.clock->is_trusted ? "stamps are taken as they are"
                                        : "stamps are brought to this machine's clock");
  }
  for (const CameraStatus& camera : status.cameras) {
    if (camera.remote) print_remote(camera.name, *camera.remote);
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  fmt::print("Peak memory: {:.0f} MB\n", static_cast<double>(usage.ru_maxrss) * 1024 / 1e6);
  if (!run.recording) return;
  const RecordingStatus recording = run.recording->status();
  fmt::print("Recorded {} frames to {}, {} dropped\n", recording.frames, recording.folder,
             recording.dropped);
  if (!recording.problem.empty()) fmt::print(stderr, "diminish: {}\n", recording.problem);
}

int LiveCommand::execute() const {
  stop_on_signals();
  LiveRun run = setup.start();
  const double start_s = monotonic_now_s();
  double next_line_s = start_s + 1;
  LiveStatus status = run.session->status();
  while (!stop_requested() && !status.ended &&
         (seconds <= 0 || monotonic_now_s() < start_s + seconds)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    run.say_output_problem();
    status = run.session->status();
    if (monotonic_now_s() < next_line_s) continue;
    print_line(status);
    next_line_s += 1;
  }
  run.virtual_camera.reset();
  run.ros2.reset();
  run.session->stop();
  if (run.recording) run.recording->finish();
  print_summary(run.session->status(), run);
  return 0;
}

}  // namespace

void add_live(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<LiveCommand>();
  CLI::App* sub = program.add_subcommand(
      "live",
      "Runs live without showing a picture: for a virtual camera, a recording, or just figures");
  command->setup.add_flags(*sub);
  command->setup.add_output_flags(*sub);
  sub->add_option("--seconds", command->seconds, "Duration; default: until interrupted")
      ->check(CLI::Range(0.0, 1e9))
      ->type_name("S");
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
