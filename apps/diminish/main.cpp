#include <oneapi/tbb/global_control.h>

#include <cstdio>
#include <exception>
#include <new>
#include <opencv2/core.hpp>

#include "commands.h"
#include "heap.h"

namespace {

constexpr int failed = 1;
constexpr int wrong_usage = 2;

/// Throws what goes wrong, but for wrong usage, which it explains.
int run_command(int argc, char** argv) {
  CLI::App program(
      "diminish removes real objects from a camera's picture and shows what is behind them.\n"
      "A colour camera is the user's eye; RGB-D cameras elsewhere see what the object hides.");
  program.name("diminish");
  program.set_version_flag("--version", DIMINISH_VERSION);
  program.require_subcommand(1);
  program.footer("Try: diminish run demo/recordings/calendar --out /tmp/calendar");
  int exit_code = 0;
  diminish::add_init(program, exit_code);
  diminish::add_run(program, exit_code);
  diminish::add_serve(program, exit_code);
  diminish::add_view(program, exit_code);
  diminish::add_live(program, exit_code);
  diminish::add_scan(program, exit_code);
  diminish::add_score(program, exit_code);
  diminish::add_report(program, exit_code);
  diminish::add_repair(program, exit_code);
  diminish::add_compare(program, exit_code);
  diminish::add_convert(program, exit_code);
  diminish::add_bench(program, exit_code);
  diminish::add_markers(program, exit_code);
  diminish::add_calibrate(program, exit_code);
  diminish::add_check(program, exit_code);
  diminish::add_sync_check(program, exit_code);
  diminish::add_latency_test(program, exit_code);
  diminish::add_devices(program, exit_code);
  diminish::add_camera_node(program, exit_code);
  diminish::add_render_node(program, exit_code);
  diminish::add_keys(program, exit_code);
  diminish::add_train_color(program, exit_code);
  diminish::add_help(program, exit_code);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : wrong_usage;
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  diminish::heap_for_pipelines();
  int exit_code = failed;
  try {
    oneapi::tbb::task_scheduler_handle workers{oneapi::tbb::attach{}};
    // Threads are given by --threads: a frame each.
    cv::setNumThreads(1);
    exit_code = run_command(argc, argv);
    // Threads that end only after main() may meet what is gone by then.
    oneapi::tbb::finalize(workers, std::nothrow);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "diminish: %s\n", error.what());
  }
  return exit_code;
}
