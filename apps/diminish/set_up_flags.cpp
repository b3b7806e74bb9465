#include "set_up_flags.h"

#include "diminish/objects_of_detector.h"

namespace diminish {

void SetUpFlags::add_to(CLI::App& command) {
  command
      .add_option("--detector", detector_,
                  "Remove what this detector finds, such as difference, instead of the objects in "
                  "scene.yaml")
      ->type_name("NAME");
  command.add_flag("--ignore-depth", ignore_depth_,
                   "Use only the RGB-D cameras' colour pictures, as if they measured no depth");
}

void SetUpFlags::apply(Rig& rig, Scene& scene) const {
  if (!detector_.empty()) scene.occluders = objects_of_detector(detector_, "--detector");
  if (ignore_depth_) rig = without_depth(rig);
}

}  // namespace diminish
