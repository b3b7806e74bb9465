#include "calibrate.h"

#include "commands.h"

namespace diminish {

void add_calibrate(CLI::App& program, int& exit_code) {
  CLI::App* calibrate =
      program.add_subcommand("calibrate", "Finds out about the cameras, and fills rig.yaml");
  calibrate->require_subcommand(1);
  add_calibrate_intrinsics(*calibrate, exit_code);
  add_calibrate_factory(*calibrate, exit_code);
  add_calibrate_rig(*calibrate, exit_code);
}

}  // namespace diminish
