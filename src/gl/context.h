#pragma once

#include <memory>
#include <string>

#include "diminish/error.h"
#include "diminish/gl_texture.h"

namespace diminish::gl {

/// The driver that draws.
struct Driver {
  std::string name;      ///< the driver's own name: "llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string version;   ///< OpenGL's, and the driver's own
  bool software = true;  ///< runs on the CPU; also if the driver does not say
};

/// An OpenGL 4.5 core context without a window, through EGL: on Mesa's surfaceless platform, else
/// on a device of the device platform. Prefers a hardware driver.
class Context {
 public:
  /// Throws Error that says what is missing.
  Context();
  /// A context that shares textures, buffers, programs and fences with another, which may be
  /// current in another thread. Throws Error that says what is wrong if that is impossible.
  static Context sharing_with(const GlSharing& application);
  static Context sharing_with(const Context& other);
  ~Context();
  Context(Context&&) noexcept;
  Context& operator=(Context&&) noexcept;

  const Driver& driver() const;
  /// Whether two contexts share their objects.
  bool shares_with(const Context& other) const;

  /// Throws Error if a call since the last check failed or the context was lost. doing: the step
  /// that the message names.
  void check(const char* doing) const;

  struct State;

 private:
  friend class Current;
  explicit Context(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// While it lives, this thread's OpenGL calls go to the context; afterwards to the one before. Code
/// that may run another frame on this thread (a TBB loop) must not be inside.
class Current {
 public:
  /// Throws Error if the context cannot be used.
  explicit Current(const Context& context);
  ~Current();
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;

 private:
  void* display_;
  void* previous_display_;
  void* previous_context_;
  void* previous_draw_;
  void* previous_read_;
};

/// Deletes what was created in the context. If the context is gone, everything in it is gone too.
template <class Resources>
void delete_in(const Context& context, std::unique_ptr<Resources>& resources) {
  try {
    const Current current(context);
    resources.reset();
  } catch (const Error&) {
    static_cast<void>(resources.release());
  }
}

/// Whether a context can be created and hardware draws.
bool has_hardware_driver();

}  // namespace diminish::gl
