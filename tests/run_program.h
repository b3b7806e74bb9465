#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "paths.h"
#include "temporary_folder.h"

namespace diminish {

/// The program as a user runs it, in its own process.
class Program {
 public:
  struct Outcome {
    int exit_code = -1;  ///< 128 + the signal's number where a signal ended it
    std::string out, err;
  };

  static Outcome run(const std::vector<std::string>& arguments) {
    return Program(arguments).wait();
  }

  explicit Program(std::vector<std::string> arguments,
                   const std::string& executable = testing::program()) {
    arguments.insert(arguments.begin(), executable);
    const std::string out = (folder_.path() / "out").string();
    const std::string err = (folder_.path() / "err").string();
    process_ = fork();
    if (process_ < 0) throw std::runtime_error("cannot fork");
    if (process_ > 0) return;
    std::vector<char*> pointers;
    pointers.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    dup2(open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
    dup2(open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    execv(pointers[0], pointers.data());
    _exit(127);
  }

  pid_t process() const { return process_; }

  Outcome wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return {code, text("out"), text("err")};
  }

 private:
  std::string text(const char* name) const {
    std::ostringstream stream;
    stream << std::ifstream(folder_.path() / name).rdbuf();
    return stream.str();
  }

  TemporaryFolder folder_;
  pid_t process_ = -1;
};

}  // namespace diminish
