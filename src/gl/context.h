#pragma once

#include <memory>
#include <string>

#include "diminish/error.h"
#include "diminish/gl_texture.h"

namespace diminish::gl {

/// What draws.
struct Driver {
  std::string name;      ///< as the driver calls itself: "llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string version;   ///< of OpenGL, and the driver's own
  bool software = true;  ///< the processor does the work; also where the driver does not say
};

/// An OpenGL 4.5 core context without a window, by EGL: on Mesa's surfaceless platform, else on a
/// device of the device platform. A hardware driver is taken before a software one.
class Context {
 public:
  /// Throws Error that says what is missing.
  Context();
  /// One that has its textures, buffers, programs and fences in common with another, which may be
  /// current in another thread. Throws Error that says what is wrong with that.
  static Context sharing_with(const GlSharing& application);
  static Context sharing_with(const Context& other);
  ~Context();
  Context(Context&&) noexcept;
  Context& operator=(Context&&) noexcept;

  const Driver& driver() const;
  /// Whether they have their objects in common.
  bool shares_with(const Context& other) const;

  /// Throws Error if a call since the last check failed or the context was lost. doing: what the
  /// message names.
  void check(const char* doing) const;

  struct State;

 private:
  friend class Current;
  explicit Context(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// While it lives, this thread's OpenGL calls go to the context; afterwards to what they went to
/// before. Nothing that may run another frame on this thread (a TBB loop) belongs inside.
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

/// Deletes what was made in the context. Where that is gone, all that it held is gone with it.
template <class Resources>
void delete_in(const Context& context, std::unique_ptr<Resources>& resources) {
  try {
    const Current current(context);
    resources.reset();
  } catch (const Error&) {
    static_cast<void>(resources.release());
  }
}

/// Whether a context can be made, and hardware draws.
bool has_hardware_driver();

}  // namespace diminish::gl
