#pragma once

#include <CLI/CLI.hpp>

namespace diminish {

void add_calibrate_intrinsics(CLI::App& calibrate, int& exit_code);
void add_calibrate_factory(CLI::App& calibrate, int& exit_code);
void add_calibrate_rig(CLI::App& calibrate, int& exit_code);

}  // namespace diminish
