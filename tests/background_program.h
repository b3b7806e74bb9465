#pragma once

#include <csignal>
#include <string>
#include <vector>

#include "run_program.h"

namespace diminish {

/// A program that runs beside the test, and is killed with this object or before.
class BackgroundProgram {
 public:
  explicit BackgroundProgram(const std::vector<std::string>& arguments,
                             const std::string& executable = testing::program())
      : program_(arguments, executable) {}
  ~BackgroundProgram() { kill_now(); }
  BackgroundProgram(const BackgroundProgram&) = delete;
  BackgroundProgram& operator=(const BackgroundProgram&) = delete;

  void kill_now() {
    if (is_killed_) return;
    is_killed_ = true;
    kill(program_.process(), SIGKILL);
    program_.wait();
  }

 private:
  Program program_;
  bool is_killed_ = false;
};

}  // namespace diminish
