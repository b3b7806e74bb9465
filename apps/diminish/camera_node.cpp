#include "live/camera_node.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <thread>

#include "commands.h"
#include "diminish/camera_source.h"
#include "live_setup.h"

namespace diminish {
namespace {

struct CameraNodeCommand {
  CameraNodeOptions node;
  std::filesystem::path rig;
  double seconds = 0;

  int execute();
};

void print_line(const CameraNodeStatus& now, const CameraNodeStatus& before, double seconds) {
  const auto rate = [&](std::size_t CameraNodeStatus::*count) {
    return static_cast<double>(now.*count - before.*count) / seconds;
  };
  fmt::print("{:>7} images  {:>5.1f} images/s  {} listeners", now.images,
             rate(&CameraNodeStatus::images), now.listeners);
  if (now.moments > before.moments) {
    const double bytes =
        rate(&CameraNodeStatus::color_bytes) + rate(&CameraNodeStatus::depth_bytes);
    fmt::print(
        "  {:.1f} Mbit/s  {:.1f} ms compressing", bytes * 8 / 1e6,
        (now.compress_ms - before.compress_ms) / static_cast<double>(now.moments - before.moments));
  }
  if (now.problem != before.problem) fmt::print("  [{}]", now.problem);
  fmt::print("\n");
  std::fflush(stdout);
}

int CameraNodeCommand::execute() {
  stop_on_signals();
  if (!rig.empty()) {
    node.rig = load_rig(std::filesystem::is_directory(rig) ? rig / "rig.yaml" : rig);
  }
  const CameraNode running(node);
  fmt::print("Publishing {} as {}\n", node.uri, node.topic);
  std::fflush(stdout);
  const double start_s = monotonic_now_s();
  double last_s = start_s;
  CameraNodeStatus last;
  CameraNodeStatus status;
  while (!stop_requested() && !status.has_ended &&
         (seconds <= 0 || monotonic_now_s() < start_s + seconds)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    status = running.status();
    const double now_s = monotonic_now_s();
    if (now_s < last_s + 1) continue;
    print_line(status, last, now_s - last_s);
    last = status;
    last_s = now_s;
  }
  return 0;
}

}  // namespace

void add_camera_node(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<CameraNodeCommand>();
  CLI::App* sub = program.add_subcommand(
      "camera-node", "Publishes a local camera on ROS 2's wire, for diminish on another machine");
  sub->add_option("camera", command->node.uri, "The camera, such as openni2: (docs/live.md)")
      ->required();
  sub->add_option(
         "--topic", command->node.topic,
         "The topics' base, such as /rgbd0; ?interface=ADDRESS lets other machines see them")
      ->required()
      ->type_name("NAME");
  command->node.name = "rgbd0";
  sub->add_option("--name", command->node.name,
                  "The camera's name in the rig; color: the user's view, without depth")
      ->capture_default_str();
  sub->add_option("--rig", command->rig,
                  "rig.yaml, or its folder, with the camera's lenses; default: the driver's")
      ->type_name("FILE");
  sub->add_option("--jpeg-quality", command->node.jpeg_quality, "Of the compressed colour images")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  sub->add_option("--seconds", command->seconds, "Duration; default: until interrupted")
      ->check(CLI::Range(0.0, 1e9))
      ->type_name("S");
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
