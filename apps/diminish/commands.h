#pragma once

#include <CLI/CLI.hpp>

namespace diminish {

// One file per subcommand. Each adds itself to the program and, when it was chosen and has run,
// leaves the program's exit code: 0 done, 3 done but for frames that could not be used.
// Errors are thrown as Error.
void add_bench(CLI::App& program, int& exit_code);
void add_calibrate(CLI::App& program, int& exit_code);
void add_camera_node(CLI::App& program, int& exit_code);
void add_render_node(CLI::App& program, int& exit_code);
void add_check(CLI::App& program, int& exit_code);
void add_compare(CLI::App& program, int& exit_code);
void add_convert(CLI::App& program, int& exit_code);
void add_devices(CLI::App& program, int& exit_code);
void add_help(CLI::App& program, int& exit_code);
void add_init(CLI::App& program, int& exit_code);
void add_keys(CLI::App& program, int& exit_code);
void add_latency_test(CLI::App& program, int& exit_code);
void add_live(CLI::App& program, int& exit_code);
void add_markers(CLI::App& program, int& exit_code);
void add_repair(CLI::App& program, int& exit_code);
void add_report(CLI::App& program, int& exit_code);
void add_run(CLI::App& program, int& exit_code);
void add_scan(CLI::App& program, int& exit_code);
void add_score(CLI::App& program, int& exit_code);
void add_serve(CLI::App& program, int& exit_code);
void add_sync_check(CLI::App& program, int& exit_code);
void add_train_color(CLI::App& program, int& exit_code);
void add_view(CLI::App& program, int& exit_code);

}  // namespace diminish
