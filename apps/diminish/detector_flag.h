#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "diminish/scene.h"

namespace diminish {

/// --detector, of all commands that remove objects.
class DetectorFlag {
 public:
  void add_flag(CLI::App& command);

  /// With the flag, replaces the scene's objects by what the detector finds without settings.
  /// Throws Error.
  void apply(Scene& scene) const;

 private:
  std::string detector_;
};

}  // namespace diminish
