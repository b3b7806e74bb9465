#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>

#include "commands.h"
#include "diminish/diminish.h"
#include "option_flags.h"
#include "progress.h"

namespace diminish {
namespace {

std::atomic<bool> stop_requested = false;

struct ScanCommand {
  std::filesystem::path recording;
  std::filesystem::path out;
  Options options;

  int execute() const;
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

int ScanCommand::execute() const {
  const Recording input = load_recording(recording);
  check(options, input.rig, input.scene);
  std::signal(SIGINT, [](int) { stop_requested = true; });
  std::signal(SIGTERM, [](int) { stop_requested = true; });
  const std::size_t frames = open_recording(input, options)->frame_count();
  RunnerOptions runner;
  runner.stop = &stop_requested;
  runner.progress = [&](std::size_t done) { show_progress(done, frames); };
  const Scan scan = scan_recording(input, options, runner);
  save_scan(scan, recording / "scene.yaml", out);
  fmt::print("{} keyframes of {} frames, with depth for {:.1f} % of their pixels\nWritten to {}\n",
             scan.frames.size(), frames, 100 * known_share(scan), out.string());
  return 0;
}

}  // namespace

void add_scan(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<ScanCommand>();
  CLI::App* sub = program.add_subcommand(
      "scan", "Keeps what a recording shows of a place, as a --background for later");
  sub->add_option("recording", command->recording,
                  "The recording's folder; objects to remove may be in view")
      ->required();
  sub->add_option("--out", command->out, "Folder for the scan: itself a short recording")
      ->required();
  add_option_flags(*sub, command->options);
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
