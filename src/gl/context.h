#pragma once

#include <memory>
#include <string>

#include "diminish/gl_texture.h"
#include "gl/own_thread.h"

namespace diminish::gl {

/// The driver that draws.
struct Driver {
  std::string name;      ///< the driver's own name: "llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string version;   ///< OpenGL's, and the driver's own
  bool software = true;  ///< runs on the CPU; also if the driver does not say
};

/// An OpenGL 4.5 core context without a window, through EGL: on Mesa's surfaceless platform, else
/// on a device of the device platform. Prefers a hardware driver. It stays current in a thread of
/// its own: hardware drivers take tens of milliseconds for the first call in a thread, and frames
/// are processed by whichever thread is free.
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

  /// Does `work`, whose OpenGL calls go to this context, in the context's thread, and waits for it.
  /// Throws what it throws. The calling thread's own context, if it has one, is left alone.
  template <class Work>
  void run(const Work& work) const {
    thread().run(work);
  }

  /// In the context's thread. Throws Error if a call since the last check failed or the context was
  /// lost. doing: the step that the message names.
  void check(const char* doing) const;

  struct State;

 private:
  explicit Context(std::unique_ptr<State> state);
  OwnThread& thread() const;
  std::unique_ptr<State> state_;
};

/// Whether a context can be created and hardware draws.
bool has_hardware_driver();

}  // namespace diminish::gl
