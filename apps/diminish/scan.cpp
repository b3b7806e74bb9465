#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "commands.h"
#include "diminish/diminish.h"
#include "live_setup.h"
#include "option_flags.h"
#include "progress.h"

namespace diminish {
namespace {

std::atomic<bool> stop_scanning = false;

struct ScanCommand {
  LiveSetup setup;  ///< its folder is the recording, or the cameras' set-up
  std::filesystem::path out;
  double seconds = 0;

  int execute();
  void record() const;
  void scan(const std::filesystem::path& recording) const;
};

/// The share of the pixels that have depth.
double known_share(const Scan& scan) {
  std::size_t known = 0;
  std::size_t all = 0;
  for (const PosedFrame& posed : scan.frames) {
    const ImageView<std::uint16_t> depth = posed.frame.rgbd.front().depth;
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 0; x < depth.width(); ++x) known += depth(x, y) != 0 ? 1 : 0;
    }
    all += static_cast<std::size_t>(depth.width()) * static_cast<std::size_t>(depth.height());
  }
  return static_cast<double>(known) / static_cast<double>(all);
}

/// Records the cameras until interrupted. Learning needs every frame in its order, with its time to
/// look behind the objects, so it is done afterwards.
void ScanCommand::record() const {
  stop_on_signals();
  const LiveRun run = setup.start();
  fmt::print("Recording to {}; Ctrl-C ends it\n", setup.record.string());
  std::fflush(stdout);
  const double start_s = monotonic_now_s();
  while (!stop_requested() && !run.session->status().ended &&
         (seconds <= 0 || monotonic_now_s() < start_s + seconds)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  run.session->stop();
  run.recording->finish();
  const RecordingStatus status = run.recording->status();
  if (!status.problem.empty()) throw Error(Error::io, status.problem);
  if (status.frames == 0) throw Error(Error::input, "scan: the cameras delivered no frame");
}

void ScanCommand::scan(const std::filesystem::path& recording) const {
  const Recording input = load_recording(recording);
  check(setup.options, input.rig, input.scene);
  std::signal(SIGINT, [](int) { stop_scanning = true; });
  std::signal(SIGTERM, [](int) { stop_scanning = true; });
  const std::size_t frames = open_recording(input, setup.options)->frame_count();
  RunnerOptions runner;
  runner.stop = &stop_scanning;
  runner.progress = [&](std::size_t done) { show_progress(done, frames); };
  const Scan scan = scan_recording(input, setup.options, runner);
  save_scan(scan, recording / "scene.yaml", out);
  fmt::print("{} keyframes of {} frames, with depth for {:.1f} % of their pixels\nWritten to {}\n",
             scan.frames.size(), frames, 100 * known_share(scan), out.string());
}

int ScanCommand::execute() {
  if (!setup.has_live_cameras(load_rig(setup.rig_file()))) {
    if (!setup.record.empty()) throw Error("--record: expected live cameras (--color, --rgbd)");
    scan(setup.folder);
    return 0;
  }
  const bool temporary = setup.record.empty();
  if (temporary) setup.record = out.string() + ".recording";
  record();
  scan(setup.record);
  if (temporary) std::filesystem::remove_all(setup.record);
  return 0;
}

}  // namespace

void add_scan(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<ScanCommand>();
  CLI::App* sub = program.add_subcommand(
      "scan",
      "Keeps what a recording or live cameras show of a place, as a --background for later");
  sub->add_option("recording", command->setup.folder,
                  "The recording's folder, or with live cameras one with rig.yaml and scene.yaml; "
                  "objects to remove may be in view")
      ->type_name("FOLDER")
      ->required();
  sub->add_option("--out", command->out, "Folder for the scan: itself a short recording")
      ->type_name("FOLDER")
      ->required();
  command->setup.add_camera_flags(*sub);
  sub->add_option("--seconds", command->seconds,
                  "How long live cameras are looked at; default: until interrupted")
      ->check(CLI::Range(0.0, 1e9))
      ->type_name("S");
  sub->add_option("--record", command->setup.record,
                  "Keep what live cameras saw in this folder, as a recording")
      ->type_name("FOLDER");
  add_option_flags(*sub, command->setup.options);
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
