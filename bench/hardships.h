#pragma once

#include <sys/resource.h>

#include <atomic>
#include <filesystem>
#include <utility>

#include "process_state.h"

#ifdef DIMINISH_HAS_GL
#include <epoxy/gl.h>
#endif

namespace diminish {

// What can be wrong around a program, each for as long as the object lives.

/// A limit of this process is lower.
class Limited {
 public:
  Limited(__rlimit_resource resource, rlim_t most) : resource_(resource) {
    getrlimit(resource_, &before_);
    const rlimit limited = {most, before_.rlim_max};
    setrlimit(resource_, &limited);
  }
  ~Limited() { setrlimit(resource_, &before_); }
  Limited(const Limited&) = delete;
  Limited& operator=(const Limited&) = delete;

 private:
  __rlimit_resource resource_;
  rlimit before_{};
};

/// Files cannot grow beyond a few kB, as on a full disk.
class FullDisk : Limited {
 public:
  FullDisk() : Limited(RLIMIT_FSIZE, 8192) {}
};

/// There is hardly more memory than what is used already.
class LittleMemory : Limited {
 public:
  LittleMemory() : Limited(RLIMIT_AS, ProcessState::address_space() + more) {}

 private:
  static constexpr rlim_t more = 8 << 20;
};

/// A folder is gone, as when its disk is taken away or can no longer be written to.
class LostFolder {
 public:
  explicit LostFolder(std::filesystem::path folder)
      : folder_(std::move(folder)), hidden_(folder_.string() + ".gone") {
    std::filesystem::rename(folder_, hidden_);
  }
  ~LostFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
    std::filesystem::rename(hidden_, folder_, ignored);
  }
  LostFolder(const LostFolder&) = delete;
  LostFolder& operator=(const LostFolder&) = delete;

 private:
  std::filesystem::path folder_, hidden_;
};

/// The driver loses the GPU's context each time that it is asked for the `every`-th time.
class LosingDriver {
 public:
  static inline std::atomic<std::size_t> lost = 0;

#ifdef DIMINISH_HAS_GL
  LosingDriver() {
    epoxy_glGetGraphicsResetStatus = &status;
  }

 private:
  static GLenum status() {
    static std::atomic<std::size_t> asked = 0;
    constexpr std::size_t every = 50;
    if (++asked % every != 0) return GL_NO_ERROR;
    ++lost;
    return GL_UNKNOWN_CONTEXT_RESET;
  }
#endif
};

}  // namespace diminish
