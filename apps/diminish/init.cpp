#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "diminish/camera_source.h"
#include "diminish/error.h"
#include "setup/init/initial_setup.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

struct InitCommand {
  std::filesystem::path folder;
  std::string color;
  std::vector<std::string> rgbd;  ///< [NAME=]CAMERA
  double marker_mm = 150;

  int execute() const;
};

std::string name_of_rgbd(std::size_t k) {
  return fmt::format("rgbd{}", k);
}

/// The connected devices: those that deliver depth, and the first one that does not.
InitialRig search() {
  InitialRig rig;
  using Sources = Registry<CameraSource>;
  for (const std::string& scheme : Sources::names()) {
    const auto& list = Sources::get(scheme).list;
    if (!list) continue;
    try {
      for (const CameraDevice& device : list()) {
        const std::string name = name_of_rgbd(rig.rgbd.size());
        try {
          FoundCamera found = look_at_camera(device.uri, name);
          if (found.depth) {
            rig.rgbd.push_back({name, {std::move(found)}});
          } else if (!rig.color.color) {
            rig.color = std::move(found);
          } else {
            fmt::print("{}: left out; {} is the user's view\n", device.uri, rig.color.uri);
          }
        } catch (const Error& error) {
          fmt::print(stderr, "diminish: {}\n", error.what());
        }
      }
    } catch (const Error& error) {
      fmt::print(stderr, "diminish: {}\n", error.what());
    }
  }
  return rig;
}

/// The cameras that the flags name.
InitialRig look_at(const std::string& color, const std::vector<std::string>& rgbd) {
  InitialRig rig;
  rig.color = look_at_camera(color, "color");
  for (const std::string& text : rgbd) {
    const std::size_t equals = text.find('=');
    const bool is_named = equals != std::string::npos && equals < text.find(':');
    const std::string name = is_named ? text.substr(0, equals) : name_of_rgbd(rig.rgbd.size());
    FoundCamera found = look_at_camera(is_named ? text.substr(equals + 1) : text, name);
    const auto same = std::find_if(rig.rgbd.begin(), rig.rgbd.end(),
                                   [&](const auto& camera) { return camera.name == name; });
    if (same != rig.rgbd.end()) {
      same->devices.push_back(std::move(found));
    } else {
      rig.rgbd.push_back({name, {std::move(found)}});
    }
  }
  return rig;
}

void print(const FoundCamera& camera, const std::string& name) {
  const auto sensor = [](const auto& intrinsics, bool is_guess) {
    if (!intrinsics) return std::string("none");
    return fmt::format("{}x{}{}", intrinsics->width, intrinsics->height,
                       is_guess ? " (lens guessed)" : "");
  };
  fmt::print("{:<8} {:<32} color {}, depth {}\n", name, camera.uri,
             sensor(camera.color, camera.color_is_guess),
             sensor(camera.depth, camera.depth_is_guess));
}

int InitCommand::execute() const {
  const std::filesystem::path rig_file = folder / "rig.yaml";
  const std::filesystem::path scene_file = folder / "scene.yaml";
  std::error_code ignored;
  for (const auto& file : {rig_file, scene_file}) {
    if (std::filesystem::exists(file, ignored)) {
      throw Error(file.string() + ": exists already, expected a new folder");
    }
  }
  if (color.empty() && !rgbd.empty()) throw Error("--color: expected a camera as well as --rgbd");
  const InitialRig rig = color.empty() ? search() : look_at(color, rgbd);
  if (!rig.color.color) {
    throw Error(
        "no camera for the user's view was found, expected one that `diminish devices` lists, or "
        "--color CAMERA");
  }
  const std::string rig_text = initial_rig_yaml(rig);
  std::filesystem::create_directories(folder, ignored);
  write_file(rig_file, rig_text);
  write_file(scene_file, initial_scene_yaml(marker_mm / 1000));

  print(rig.color, "color");
  for (const InitialRig::Rgbd& camera : rig.rgbd) {
    for (const FoundCamera& device : camera.devices) print(device, camera.name);
  }
  if (rig.rgbd.empty()) {
    fmt::print(
        "No depth camera was found. Add one with --rgbd CAMERA, or look around first: diminish "
        "scan --help\n");
  }
  fmt::print(
      "\nWritten: {}, {}. Next:\n"
      "  diminish markers --ids 0 --size-mm {:g} --out marker.pdf   # print it, put it where all "
      "cameras see it\n"
      "  diminish serve {}\n"
      "  diminish check {}   # what would make it better\n",
      rig_file.string(), scene_file.string(), marker_mm, folder.string(), folder.string());
  return 0;
}

}  // namespace

void add_init(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<InitCommand>();
  CLI::App* sub = program.add_subcommand(
      "init", "Begins a set-up: looks at the cameras and writes rig.yaml and scene.yaml");
  sub->add_option("folder", command->folder, "The set-up's folder; created if missing")->required();
  sub->add_option("--color", command->color,
                  "The camera of the user's view; without it the connected devices are searched")
      ->type_name("CAMERA");
  sub->add_option("--rgbd", command->rgbd,
                  "An RGB-D camera; twice with the same NAME for separate colour and depth devices")
      ->type_name("[NAME=]CAMERA");
  sub->add_option("--marker-mm", command->marker_mm, "The side of the world marker's black square")
      ->check(CLI::Range(10., 2000.))
      ->capture_default_str();
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
