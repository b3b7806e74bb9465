#pragma once

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "commands.h"
#include "diminish/camera_source.h"
#include "diminish/rig.h"
#include "live_setup.h"

// What the programs beside a camera have in common: camera-node and render-node.

namespace diminish {

template <class Options>
struct NodeCommand {
  Options node;
  std::filesystem::path rig;
  double seconds = 0;
};

/// Runs until it is interrupted, the time is over or the camera has ended. print_line(now, before,
/// seconds): once a second.
template <class Node, class Status, class Options, class PrintLine>
int run_node(NodeCommand<Options>& command, const std::string& announcement,
             const PrintLine& print_line) {
  stop_on_signals();
  if (!command.rig.empty()) {
    command.node.rig = load_rig(
        std::filesystem::is_directory(command.rig) ? command.rig / "rig.yaml" : command.rig);
  }
  const Node running(command.node);
  fmt::print("{}\n", announcement);
  std::fflush(stdout);
  const double start_s = monotonic_now_s();
  double last_s = start_s;
  Status last;
  Status status;
  while (!stop_requested() && !status.has_ended &&
         (command.seconds <= 0 || monotonic_now_s() < start_s + command.seconds)) {
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

/// The camera, where it is published, its name and its rig.
template <class Options>
void add_node_flags(CLI::App& sub, NodeCommand<Options>& command, const std::string& name,
                    const std::string& rig) {
  sub.add_option("camera", command.node.uri, "The camera, such as openni2: (docs/live.md)")
      ->required();
  sub.add_option(
         "--topic", command.node.topic,
         "The topics' base, such as /rgbd0; ?interface=ADDRESS lets other machines see them")
      ->required()
      ->type_name("NAME");
  command.node.name = "rgbd0";
  sub.add_option("--name", command.node.name, name)->capture_default_str();
  sub.add_option("--rig", command.rig, rig)->type_name("FILE");
}

template <class Options>
void add_node_seconds(CLI::App& sub, NodeCommand<Options>& command) {
  sub.add_option("--seconds", command.seconds, "Duration; default: until interrupted")
      ->check(CLI::Range(0.0, 1e9))
      ->type_name("S");
}

}  // namespace diminish
