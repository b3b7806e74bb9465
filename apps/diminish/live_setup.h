#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "background.h"
#include "diminish/live.h"
#include "diminish/recording_writer.h"
#include "diminish/ros2_output.h"
#include "diminish/virtual_camera.h"
#include "set_up_flags.h"

namespace diminish {

/// A running session and what it writes.
struct LiveRun {
  std::unique_ptr<LiveSession> session;
  std::shared_ptr<RecordingWriter> recording;  ///< null: none is made
  std::shared_ptr<void> recording_listener;
  std::unique_ptr<VirtualCamera> virtual_camera;
  std::unique_ptr<Ros2Output> ros2;

  /// Once, if the virtual camera or ROS 2 no longer works.
  void say_output_problem();
};

/// What the live commands (live, serve, view, latency-test) have in common: set-up, cameras,
/// options.
struct LiveSetup {
  std::filesystem::path folder;
  std::string color;
  std::vector<std::string> rgbd;
  std::filesystem::path record;
  std::string virtual_camera;
  std::string ros2;         ///< the topics' base, and its network
  bool draw_clock = false;  ///< into the colour camera's pictures
  Options options;
  Background background;
  SetUpFlags flags;
  LiveOptions live_options;

  void add_flags(CLI::App& command);
  /// --color and --rgbd
  void add_camera_flags(CLI::App& command);
  /// --record, --virtual-camera and --ros2
  void add_output_flags(CLI::App& command);

  std::filesystem::path rig_file() const { return folder / "rig.yaml"; }
  std::filesystem::path scene_file() const { return folder / "scene.yaml"; }
  /// Loads the set-up and starts. Throws Error.
  LiveRun start() const;
  /// Whether cameras are named, by flags or by a set-up that is no recording.
  bool has_live_cameras(const Rig& rig) const;
  /// Those; without any the folder as a recording. The first is the user's view. Throws Error.
  std::vector<LiveCamera> cameras(const Rig& rig) const;
};

/// Asks for SIGINT and SIGTERM to end the command; whether that has happened.
void stop_on_signals();
bool stop_requested();

}  // namespace diminish
