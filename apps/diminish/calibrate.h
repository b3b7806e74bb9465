#pragma once

#include <CLI/CLI.hpp>

namespace diminish {

/// The exit code of a calibration that says what to look at.
inline constexpr int done_with_warnings = 3;

void add_calibrate_intrinsics(CLI::App& calibrate, int& exit_code);
void add_calibrate_factory(CLI::App& calibrate, int& exit_code);
void add_calibrate_rig(CLI::App& calibrate, int& exit_code);

}  // namespace diminish
