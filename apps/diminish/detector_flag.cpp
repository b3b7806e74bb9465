#include "detector_flag.h"

namespace diminish {

void DetectorFlag::add_flag(CLI::App& command) {
  command
      .add_option("--detector", detector_,
                  "Remove what this detector finds, such as difference, instead of the objects in "
                  "scene.yaml")
      ->type_name("NAME");
}

void DetectorFlag::apply(Scene& scene) const {
  if (detector_.empty()) return;
  const Config object = Config::parse(
      "occluders:\n  - name: object\n    detector: \"" + detector_ + "\"", "--detector");
  scene.occluders = read_scene(object).occluders;
}

}  // namespace diminish
