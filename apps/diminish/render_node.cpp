#include "live/render_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <thread>

#include "commands.h"
#include "diminish/camera_source.h"
#include "live_setup.h"

namespace diminish {
namespace {

struct RenderNodeCommand {
  RenderNodeOptions node;
  std::filesystem::path rig;
  double seconds = 0;

  int execute();
};

void print_line(const RenderNodeStatus& now, const RenderNodeStatus& before, double seconds) {
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

int RenderNodeCommand::execute() {
  stop_on_signals();
  if (!rig.empty()) {
    node.rig = load_rig(std::filesystem::is_directory(rig) ? rig / "rig.yaml" : rig);
  }
  const RenderNode running(node);
  fmt::print("Drawing {} for those who ask at {}\n", node.uri, node.topic);
  std::fflush(stdout);
  const double start_s = monotonic_now_s();
  double last_s = start_s;
  RenderNodeStatus last;
  RenderNodeStatus status;
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

void add_render_node(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<RenderNodeCommand>();
  CLI::App* sub = program.add_subcommand("render-node",
                                         "Draws what a local RGB-D camera sees for users on other "
                                         "machines, and sends them that alone");
  sub->add_option("camera", command->node.uri, "The camera, such as openni2: (docs/live.md)")
      ->required();
  sub->add_option(
         "--topic", command->node.topic,
         "The topics' base, such as /rgbd0; ?interface=ADDRESS lets other machines see them")
      ->required()
      ->type_name("NAME");
  command->node.name = "rgbd0";
  sub->add_option("--name", command->node.name, "The camera's name in the rig")
      ->capture_default_str();
  sub->add_option("--rig", command->rig,
                  "rig.yaml, or its folder, if the camera's driver is to be told its image sizes; "
                  "lenses come from the user's machine")
      ->type_name("FILE");
  sub->add_option("--seconds", command->seconds, "Duration; default: until interrupted")
      ->check(CLI::Range(0.0, 1e9))
      ->type_name("S");
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
