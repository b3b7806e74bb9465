#pragma once

#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include "run_program.h"

namespace diminish {

/// A program that runs beside the test, and is ended with this object or killed before. What is
/// killed leaves its shared memory behind.
class BackgroundProgram {
 public:
  explicit BackgroundProgram(const std::vector<std::string>& arguments,
                             const std::string& executable = testing::program())
      : program_(arguments, executable) {}
  ~BackgroundProgram() {
    constexpr int patience_s = 5;
    if (is_killed_ || kill(program_.process(), SIGTERM) != 0) return;
    for (int i = 0; i < 100 * patience_s && !has_ended(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    kill_now();
  }
  BackgroundProgram(const BackgroundProgram&) = delete;
  BackgroundProgram& operator=(const BackgroundProgram&) = delete;

  void kill_now() {
    if (is_killed_) return;
    is_killed_ = true;
    kill(program_.process(), SIGKILL);
    program_.wait();
  }

 private:
  /// It is still there to be waited for.
  bool has_ended() const {
    siginfo_t info{};
    return waitid(P_PID, static_cast<id_t>(program_.process()), &info,
                  WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid != 0;
  }

  Program program_;
  bool is_killed_ = false;
};

}  // namespace diminish
