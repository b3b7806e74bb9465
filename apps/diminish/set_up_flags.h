#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// What all commands that remove objects may be told instead of what the files of the set-up say.
class SetUpFlags {
 public:
  void add_to(CLI::App& command);

  /// --detector: the objects are what the detector finds without settings. --ignore-depth: the
  /// rig's cameras measure no depth. Throws Error.
  void apply(Rig& rig, Scene& scene) const;

 private:
  std::string detector_;
  bool ignore_depth_ = false;
};

}  // namespace diminish
