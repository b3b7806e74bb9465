#pragma once

#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

namespace diminish {

/// What this process holds now.
struct ProcessState {
  double memory_mb = 0;  ///< resident
  long handles = 0;      ///< open files and sockets
  long threads = 0;

  /// Bytes.
  static std::size_t address_space() {
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  }

  static ProcessState now() {
    ProcessState state;
    long pages = 0;
    long resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    state.memory_mb = static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) /
                      (1024. * 1024.);
    state.handles = count("/proc/self/fd");
    state.threads = count("/proc/self/task");
    return state;
  }

  /// How many threads of each name there are now: "camera", "llvmpipe-0".
  static std::map<std::string, long> thread_names() {
    std::map<std::string, long> names;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
      std::string name;
      std::getline(std::ifstream(task.path() / "comm"), name);
      if (!name.empty()) ++names[name];
    }
    return names;
  }

 private:
  static long count(const char* folder) {
    return std::distance(std::filesystem::directory_iterator(folder),
                         std::filesystem::directory_iterator());
  }
};

}  // namespace diminish
