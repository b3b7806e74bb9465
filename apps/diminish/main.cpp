#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <opencv2/core.hpp>

#include "commands.h"

namespace {

constexpr int failed = 1;
constexpr int wrong_usage = 2;

}  // namespace

int main(int argc, char** argv) {
  // Threads are given by --threads: a frame each.
  cv::setNumThreads(1);
  CLI::App program(
      "diminish removes real objects from a camera's picture and shows what is behind them.\n"
      "A colour camera is the user's eye; RGB-D cameras elsewhere see what the object hides.");
  program.name("diminish");
  program.set_version_flag("--version", DIMINISH_VERSION);
  program.require_subcommand(1);
  program.footer("Try: diminish run demo/recordings/calendar --out /tmp/calendar");
  int exit_code = 0;
  try {
    diminish::add_run(program, exit_code);
    diminish::add_serve(program, exit_code);
    diminish::add_view(program, exit_code);
    diminish::add_live(program, exit_code);
    diminish::add_scan(program, exit_code);
    diminish::add_score(program, exit_code);
    diminish::add_report(program, exit_code);
    diminish::add_compare(program, exit_code);
    diminish::add_bench(program, exit_code);
    diminish::add_markers(program, exit_code);
    diminish::add_calibrate(program, exit_code);
    diminish::add_check(program, exit_code);
    diminish::add_sync_check(program, exit_code);
    diminish::add_latency_test(program, exit_code);
    diminish::add_devices(program, exit_code);
    diminish::add_train_color(program, exit_code);
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : wrong_usage;
  } catch (const std::exception& error) {
    fmt::print(stderr, "diminish: {}\n", error.what());
    return failed;
  }
  return exit_code;
}
