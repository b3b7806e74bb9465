#pragma once

#include <epoxy/gl.h>

#include <memory>
#include <string>
#include <vector>

#include "diminish/gpu_pass.h"

namespace diminish::gl {

/// Measures the GPU's time in each pass of a frame by timer queries.
class PassTimer {
 public:
  PassTimer() = default;
  ~PassTimer() {
    if (!queries_.empty()) glDeleteQueries(static_cast<GLsizei>(queries_.size()), queries_.data());
  }
  PassTimer(const PassTimer&) = delete;
  PassTimer& operator=(const PassTimer&) = delete;

  /// Forgets the last frame's passes.
  void begin_frame() { names_.clear(); }

  /// Calls `pass`, whose time will be called `name`.
  template <class Pass>
  void measure(const char* name, const Pass& pass) {
    if (names_.size() == queries_.size()) {
      queries_.push_back(0);
      glCreateQueries(GL_TIME_ELAPSED, 1, &queries_.back());
    }
    names_.push_back(name);
    glBeginQuery(GL_TIME_ELAPSED, queries_[names_.size() - 1]);
    pass();
    glEndQuery(GL_TIME_ELAPSED);
  }

  /// Adds the frame's passes to `times`. Waits for the GPU where it has not finished.
  void read(std::vector<GpuPass>& times) const {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      GLuint64 nanoseconds = 0;
      glGetQueryObjectui64v(queries_[i], GL_QUERY_RESULT, &nanoseconds);
      times.push_back({names_[i], static_cast<double>(nanoseconds) * 1e-6});
    }
  }

 private:
  std::vector<const char*> names_;
  std::vector<GLuint> queries_;
};

}  // namespace diminish::gl
