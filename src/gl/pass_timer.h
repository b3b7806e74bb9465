#pragma once

#include <epoxy/gl.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "diminish/gpu_pass.h"

namespace diminish::gl {

/// Measures the GPU's time in each pass of a frame with timestamp queries. A software driver's
/// queries say little about compute shaders, so there each pass is finished before its clock is
/// read: the CPU does the work, and nothing else waits.
class PassTimer {
 public:
  explicit PassTimer(bool software) : software_(software) {}
  ~PassTimer() {
    if (!queries_.empty()) glDeleteQueries(static_cast<GLsizei>(queries_.size()), queries_.data());
  }
  PassTimer(const PassTimer&) = delete;
  PassTimer& operator=(const PassTimer&) = delete;

  /// Forgets the last frame's passes.
  void begin_frame() {
    names_.clear();
    times_ns_.clear();
    mark();
  }

  /// Calls `pass` and measures it as `name`. A name may be used again.
  template <class Pass>
  void measure(const char* name, const Pass& pass) {
    pass();
    names_.push_back(name);
    mark();
  }

  /// Returns the frame's passes in the order of their first call. Waits for the GPU if it has not
  /// finished.
  void read(std::vector<GpuPass>& passes) {
    passes.clear();
    for (std::size_t i = 0; i < times_ns_.size() && !software_; ++i) {
      glGetQueryObjecti64v(queries_[i], GL_QUERY_RESULT, &times_ns_[i]);
    }
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const double ms = static_cast<double>(times_ns_[i + 1] - times_ns_[i]) * 1e-6;
      const auto same = std::find_if(passes.begin(), passes.end(), [&](const GpuPass& pass) {
        return std::string_view(pass.name) == names_[i];
      });
      if (same == passes.end()) {
        passes.push_back({names_[i], ms});
      } else {
        same->milliseconds += ms;
      }
    }
  }

 private:
  void mark() {
    GLint64 now_ns = 0;
    if (software_) {
      glFinish();
      glGetInteger64v(GL_TIMESTAMP, &now_ns);
    } else {
      if (times_ns_.size() == queries_.size()) {
        queries_.push_back(0);
        glCreateQueries(GL_TIMESTAMP, 1, &queries_.back());
      }
      glQueryCounter(queries_[times_ns_.size()], GL_TIMESTAMP);
    }
    times_ns_.push_back(now_ns);
  }

  bool software_;
  std::vector<const char*> names_;
  std::vector<GLint64> times_ns_;  ///< before the first pass and after each
  std::vector<GLuint> queries_;
};

}  // namespace diminish::gl
