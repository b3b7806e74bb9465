#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "calibrate.h"
#include "diminish/camera_source.h"
#include "diminish/error.h"
#include "setup/calibrate/rig_file.h"

namespace diminish {
namespace {

struct CalibrateFactoryCommand {
  std::string uri;
  std::string camera = "rgbd0";
  std::filesystem::path out;

  int execute() const;
};

/// A camera on the network tells its lenses with its first images.
void wait_for_intrinsics(CameraSource& source) {
  constexpr double patience_s = 2;
  CameraImage image;
  for (const double end_s = monotonic_now_s() + patience_s;
       monotonic_now_s() < end_s &&
       !(source.intrinsics(Sensor::color) && source.intrinsics(Sensor::depth));) {
    source.read(image, std::chrono::milliseconds(100));
  }
}

int CalibrateFactoryCommand::execute() const {
  RigFile rig(out);
  const auto source = open_camera(uri, {.name = camera, .rig = nullptr});
  wait_for_intrinsics(*source);
  int known = 0;
  for (const auto& [sensor, kind] : {std::pair{Sensor::color, "color"}, {Sensor::depth, "depth"}}) {
    const auto intrinsics = source->intrinsics(sensor);
    const bool is_users_view = camera == "color";
    if (!intrinsics || (is_users_view && sensor == Sensor::depth)) continue;
    const std::string name = is_users_view ? camera : camera + "_" + kind;
    rig.set_intrinsics(name, *intrinsics);
    fmt::print("{}: {}x{} pixels, fx {:.2f}, fy {:.2f}, cx {:.2f}, cy {:.2f}\n", name,
               intrinsics->width, intrinsics->height, intrinsics->fx, intrinsics->fy,
               intrinsics->cx, intrinsics->cy);
    ++known;
  }
  if (known == 0) throw Error(uri + ": its driver does not know the camera's intrinsics");
  rig.write();
  fmt::print("Written to {}\n", out.string());
  return 0;
}

}  // namespace

void add_calibrate_factory(CLI::App& calibrate, int& exit_code) {
  auto command = std::make_shared<CalibrateFactoryCommand>();
  CLI::App* sub = calibrate.add_subcommand(
      "factory", "Writes the intrinsics that a camera's driver knows; calibrated ones are better");
  sub->add_option("uri", command->uri, "The camera, such as openni2: (docs/live.md)")->required();
  sub->add_option("--camera", command->camera, "The camera's name in the rig")
      ->capture_default_str();
  sub->add_option("--out", command->out,
                  "The rig.yaml to write this camera's blocks into; the rest stays as it is")
      ->type_name("FILE")
      ->required();
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
