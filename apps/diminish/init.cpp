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
  std::vector<std::string> rgbd, color_only;  ///< [NAME=]CAMERA
  double marker_mm = 140;                     ///< fits on A4

  int execute() const;
};

std::string numbered(const char* kind, const std::vector<InitialRig::Named>& before) {
  return fmt::format("{}{}", kind, before.size());
}

/// The connected devices: those that deliver depth, and the first one that does not. Without any
/// depth, the others that do not, too.
InitialRig search() {
  InitialRig rig;
  using Sources = Registry<CameraSource>;
  for (const std::string& scheme : Sources::names()) {
    const auto& list = Sources::get(scheme).list;
    if (!list) continue;
    try {
      for (const CameraDevice& device : list()) {
        const std::string name = numbered("rgbd", rig.rgbd);
        try {
          FoundCamera found = look_at_camera(device.uri, name);
          if (found.depth) {
            rig.rgbd.push_back({name, {std::move(found)}});
          } else if (!rig.color.color) {
            rig.color = std::move(found);
          } else {
            rig.color_only.push_back({numbered("camera", rig.color_only), {std::move(found)}});
          }
        } catch (const Error& error) {
          fmt::print(stderr, "diminish: {}\n", error.what());
        }
      }
    } catch (const Error& error) {
      fmt::print(stderr, "diminish: {}\n", error.what());
    }
  }
  if (rig.rgbd.empty()) return rig;
  for (const InitialRig::Named& camera : rig.color_only) {
    fmt::print("{}: left out; {} is the user's view\n", camera.devices[0].uri, rig.color.uri);
  }
  rig.color_only.clear();
  return rig;
}

/// Looks at the cameras that a flag names. Without a name they are numbered.
void look_at(const std::vector<std::string>& flags, const char* kind,
             std::vector<InitialRig::Named>& cameras) {
  for (const std::string& text : flags) {
    const std::size_t equals = text.find('=');
    const bool is_named = equals != std::string::npos && equals < text.find(':');
    const std::string name = is_named ? text.substr(0, equals) : numbered(kind, cameras);
    FoundCamera found = look_at_camera(is_named ? text.substr(equals + 1) : text, name);
    const auto same = std::find_if(cameras.begin(), cameras.end(),
                                   [&](const auto& camera) { return camera.name == name; });
    if (same != cameras.end()) {
      same->devices.push_back(std::move(found));
    } else {
      cameras.push_back({name, {std::move(found)}});
    }
  }
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
  InitialRig rig;
  if (!color.empty()) {
    rig.color = look_at_camera(color, "color");
    look_at(rgbd, "rgbd", rig.rgbd);
    look_at(color_only, "camera", rig.color_only);
  } else if (rgbd.empty() && color_only.empty()) {
    rig = search();
  } else {
    throw Error("--color: expected a camera as well as --rgbd or --camera");
  }
  if (!rig.color.color) {
    throw Error(
        "no camera for the user's view was found, expected one that `diminish devices` lists, or "
        "--color CAMERA");
  }
  const std::string rig_text = initial_rig_yaml(rig);
  std::filesystem::create_directories(folder, ignored);
  write_file(rig_file, rig_text);
  write_file(scene_file, initial_scene_yaml(rig, marker_mm / 1000));

  print(rig.color, "color");
  for (const auto* const cameras : {&rig.rgbd, &rig.color_only}) {
    for (const InitialRig::Named& camera : *cameras) {
      for (const FoundCamera& device : camera.devices) print(device, camera.name);
    }
  }
  fmt::print(
      "\nWritten: {}, {}. Next:\n"
      "  diminish markers --ids 0 --size-mm {:g} --out marker.pdf   # print it, put it where all "
      "cameras see it\n",
      rig_file.string(), scene_file.string(), marker_mm);
  if (rig.rgbd.empty()) {
    fmt::print(
        "  diminish markers --ids {} --size-mm {:g} --out object.pdf   # put it on the object: "
        "without a depth camera (--rgbd CAMERA), a marker tells what is removed; its corners are "
        "in scene.yaml\n",
        initial_object_marker, 1000 * initial_object_marker_m);
  }
  fmt::print(
      "  diminish serve {}\n"
      "  diminish check {}   # what would make it better\n",
      folder.string(), folder.string());
  return 0;
}

}  // namespace

void add_init(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<InitCommand>();
  CLI::App* sub = program.add_subcommand(
      "init", "Begins a set-up: looks at the cameras and writes rig.yaml and scene.yaml");
  sub->add_option("folder", command->folder, "The set-up's folder; created if missing")
      ->type_name("FOLDER")
      ->required();
  sub->add_option("--color", command->color,
                  "The camera of the user's view; without it the connected devices are searched")
      ->type_name("CAMERA");
  sub->add_option("--rgbd", command->rgbd,
                  "An RGB-D camera; twice with the same NAME for separate colour and depth devices")
      ->type_name("[NAME=]CAMERA");
  sub->add_option("--camera", command->color_only,
                  "A colour camera beside the user's: one sees what is flat, two find depth")
      ->type_name("[NAME=]CAMERA");
  sub->add_option("--marker-mm", command->marker_mm, "The side of the world marker's black square")
      ->check(CLI::Range(10., 2000.))
      ->capture_default_str();
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
