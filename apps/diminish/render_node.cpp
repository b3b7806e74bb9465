#include "live/render_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "node_command.h"

namespace diminish {
namespace {

void print_render_node(const RenderNodeStatus& now, const RenderNodeStatus& before,
                       double seconds) {
  fmt::print("{:>7} images  {} users", now.images, now.users);
  const std::size_t layers = now.layers - before.layers;
  if (layers > 0) {
    const auto bytes = static_cast<double>(now.glance_bytes + now.layer_bytes -
                                           before.glance_bytes - before.layer_bytes);
    const auto each = [&](double RenderNodeStatus::*ms) {
      return (now.*ms - before.*ms) / static_cast<double>(layers);
    };
    fmt::print(
        "  {:.1f} layers/s  {:.1f} Mbit/s ({:.1f} kB glance, {:.1f} kB layer)  "
        "{:.1f} ms reading, {:.1f} drawing, {:.1f} compressing",
        static_cast<double>(layers) / seconds, bytes * 8 / 1e6 / seconds,
        static_cast<double>(now.glance_bytes - before.glance_bytes) / 1e3 /
            static_cast<double>(std::max<std::size_t>(1, now.glances - before.glances)),
        static_cast<double>(now.layer_bytes - before.layer_bytes) / 1e3 /
            static_cast<double>(layers),
        each(&RenderNodeStatus::glance_ms), each(&RenderNodeStatus::draw_ms),
        each(&RenderNodeStatus::compress_ms));
  }
  for (const auto& [text, old] : {std::pair{&now.problem, &before.problem},
                                  std::pair{&now.camera_problem, &before.camera_problem}}) {
    if (*text != *old) fmt::print("  [{}]", *text);
  }
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace

void add_render_node(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<NodeCommand<RenderNodeOptions>>();
  CLI::App* sub = program.add_subcommand("render-node",
                                         "Draws what a local RGB-D camera sees for users on other "
                                         "machines, and sends them that alone");
  add_node_flags(*sub, *command, "The camera's name in the rig",
                 "rig.yaml, or its folder, if the camera's driver is to be told its image sizes; "
                 "lenses come from the user's machine");
  add_node_seconds(*sub, *command);
  sub->callback([command, &exit_code] {
    exit_code = run_node<RenderNode, RenderNodeStatus>(
        *command,
        fmt::format("Drawing {} for those who ask at {}", command->node.uri, command->node.topic),
        print_render_node);
  });
}

}  // namespace diminish
