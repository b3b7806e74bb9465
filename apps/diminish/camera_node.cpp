#include "live/camera_node.h"

#include <fmt/format.h>

#include <memory>

#include "node_command.h"

namespace diminish {
namespace {

void print_camera_node(const CameraNodeStatus& now, const CameraNodeStatus& before,
                       double seconds) {
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

}  // namespace

void add_camera_node(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<NodeCommand<CameraNodeOptions>>();
  CLI::App* sub = program.add_subcommand(
      "camera-node", "Publishes a local camera on ROS 2's wire, for diminish on another machine");
  add_node_flags(*sub, *command,
                 "The camera's name in the rig; color: the user's view, without depth",
                 "rig.yaml, or its folder, with the camera's lenses; default: the driver's");
  sub->add_option("--jpeg-quality", command->node.jpeg_quality, "Of the compressed colour images")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  add_node_seconds(*sub, *command);
  sub->callback([command, &exit_code] {
    exit_code = run_node<CameraNode, CameraNodeStatus>(
        *command, fmt::format("Publishing {} as {}", command->node.uri, command->node.topic),
        print_camera_node);
  });
}

}  // namespace diminish
