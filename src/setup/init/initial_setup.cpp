#include "setup/init/initial_setup.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "diminish/camera_source.h"
#include "diminish/error.h"
#include "source/rig_yaml.h"

namespace diminish {
namespace {

constexpr double patience_s = 5;
/// A camera with two sensors delivers both within this time of the first image.
constexpr double second_sensor_s = 1;

/// Usual lenses see 60 to 65 degrees.
Intrinsics guess(int width, int height) {
  constexpr double focal_length = 0.82;  // picture widths
  Intrinsics intrinsics;
  intrinsics.width = width;
  intrinsics.height = height;
  intrinsics.fx = intrinsics.fy = std::round(focal_length * width);
  intrinsics.cx = (width - 1) / 2.;
  intrinsics.cy = (height - 1) / 2.;
  return intrinsics;
}

constexpr const char* guessed =
    "   # a guess from the image's size: `diminish calibrate intrinsics` measures it";

std::string line(const char* name, const Intrinsics& intrinsics, bool is_guess) {
  return fmt::format("{}: {}{}\n", name, as_yaml(intrinsics), is_guess ? guessed : "");
}

const FoundCamera& device_with(const InitialRig::Named& camera,
                               std::optional<Intrinsics> FoundCamera::*sensor, const char* what) {
  for (const FoundCamera& device : camera.devices) {
    if (device.*sensor) return device;
  }
  std::string uris;
  for (const FoundCamera& device : camera.devices) uris += (uris.empty() ? "" : ", ") + device.uri;
  throw Error(
      fmt::format("{}: {} delivers no {} images, expected color and depth; give the camera "
                  "that does as well: --rgbd {}=CAMERA",
                  camera.name, uris, what, camera.name));
}

}  // namespace

FoundCamera look_at_camera(const std::string& uri, const std::string& name) {
  FoundCamera found;
  found.uri = uri;
  CameraRequest request;
  request.name = name;
  request.epoch_s = monotonic_now_s();
  const auto source = open_camera(uri, request);
  double end_s = request.epoch_s + patience_s;
  CameraImage image;
  while (monotonic_now_s() < end_s && !(found.color && found.depth)) {
    const auto status = source->read(image, std::chrono::milliseconds(200));
    if (status == CameraSource::Status::end) break;
    if (status != CameraSource::Status::image || !image.fault.empty()) continue;
    if (!found.color && !found.depth) end_s = monotonic_now_s() + second_sensor_s;
    const bool is_color = image.sensor == Sensor::color;
    const auto known = source->intrinsics(image.sensor);
    (is_color ? found.color_is_guess : found.depth_is_guess) = !known;
    (is_color ? found.color : found.depth) = known ? *known
                                             : is_color
                                                 ? guess(image.color.width(), image.color.height())
                                                 : guess(image.depth.width(), image.depth.height());
    // The user's view is all that is asked of its camera.
    if (name == "color" && found.color) break;
  }
  found.color_from_depth = source->color_from_depth();
  if (!found.color && !found.depth) {
    throw Error(
        fmt::format("{}: no image within {} s, expected a camera that runs", uri, patience_s));
  }
  return found;
}

std::string initial_rig_yaml(const InitialRig& rig) {
  if (!rig.color.color)
    throw Error(rig.color.uri + ": delivers no color images, expected the user's view");
  std::string text =
      "# Made by `diminish init`. What is a guess says so; docs/setting-up.md says how to measure "
      "it.\n"
      "live:   # what `diminish serve` opens; color is the user's view\n";
  const auto add = [&text](const std::string& name, const std::string& uri) {
    text += fmt::format("  - {{camera: {}, uri: {}}}\n", name, nlohmann::json(uri).dump());
  };
  add("color", rig.color.uri);
  for (const auto* const cameras : {&rig.rgbd, &rig.color_only}) {
    for (const InitialRig::Named& camera : *cameras) {
      for (const FoundCamera& device : camera.devices) add(camera.name, device.uri);
    }
  }
  text += line("color", *rig.color.color, rig.color.color_is_guess);
  text += rig.rgbd.empty() ? "rgbd: []\n" : "rgbd:\n";
  for (const InitialRig::Named& camera : rig.rgbd) {
    const FoundCamera& color = device_with(camera, &FoundCamera::color, "color");
    const FoundCamera& depth = device_with(camera, &FoundCamera::depth, "depth");
    text += fmt::format("  - name: {}\n", camera.name);
    text += "    " + line("color", *color.color, color.color_is_guess);
    text += "    " + line("depth", *depth.depth, depth.depth_is_guess);
    text += "    depth_unit_m: 0.001   # millimetres, as most drivers deliver\n";
    text += fmt::format(
        "    color_from_depth: {}   # {}\n",
        as_yaml(depth.color_from_depth.value_or(RigidTransform{})),
        depth.color_from_depth
            ? "as the camera's driver tells it"
            : "a guess, that both sensors are one: `diminish calibrate rig RECORDING --depth` "
              "measures it");
  }
  if (!rig.color_only.empty()) text += "cameras:   # without depth, which is estimated\n";
  for (const InitialRig::Named& camera : rig.color_only) {
    const FoundCamera& color = device_with(camera, &FoundCamera::color, "color");
    text += fmt::format("  - name: {}\n", camera.name);
    text += "    " + line("color", *color.color, color.color_is_guess);
    text += "    range_m: [0.4, 6]   # where surfaces are; a narrower range saves time\n";
  }
  text +=
      "pose:\n"
      "  source: marker   # the world marker in scene.yaml, which all cameras must see. For "
      "cameras "
      "that do not move:\n"
      "                   # `diminish calibrate rig` (source: fixed)\n";
  return text;
}

std::string initial_scene_yaml(const InitialRig& rig, double marker_size_m) {
  std::string text = fmt::format(
      "# Made by `diminish init`.\n"
      "world_marker: {{id: 0, size_m: {}}}   # the black square's side: measure the printed one\n"
      "occluders:\n"
      "  - name: object\n",
      marker_size_m);
  if (!rig.rgbd.empty()) {
    return text +
           "    detector: difference   # whatever stands free in front of what the RGB-D cameras "
           "see\n"
           "    clearance: 0.3         # how free: the share of the way to the background, at "
           "least\n";
  }
  text += fmt::format(
      "    detector: marker   # what carries the marker; `difference` needs a depth camera\n"
      "    marker: {{id: {}, size_m: {}}}\n"
      "    # The object's corners in the marker's frame, metres (x right, y up, z out of the "
      "marker): put in yours.\n"
      "    vertices: [[-0.1, -0.1, 0], [0.1, -0.1, 0], [-0.1, 0.1, 0], [0.1, 0.1, 0],\n"
      "               [-0.1, -0.1, -0.02], [0.1, -0.1, -0.02], [-0.1, 0.1, -0.02], [0.1, 0.1, "
      "-0.02]]\n",
      initial_object_marker, initial_object_marker_m);
  if (rig.color_only.size() == 1) {
    text +=
        "planes: [{features: 2}]   # what stands behind it: up to two planes, found in the "
        "pictures\n";
  }
  return text;
}

}  // namespace diminish
