#include "detector_flag.h"

#include "diminish/objects_of_detector.h"

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
  scene.occluders = objects_of_detector(detector_, "--detector");
}

}  // namespace diminish
