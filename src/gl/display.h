#pragma once

#include <string_view>

namespace diminish::gl {

// EGL's handles are pointers: what they point to is EGL's own.

/// A place where contexts can be made.
struct Display {
  void* display = nullptr;  ///< EGLDisplay, initialised
  bool software = true;     ///< the processor draws
};

/// The first display with a hardware driver, else the first that can do what is needed. Throws
/// Error where there is none.
const Display& chosen_display();

/// Throws Error where there is no EGL: before any other call of it.
void expect_egl_library();

/// True also where the platform does not say.
bool draws_in_software(void* display);

/// An EGLContext of OpenGL 4.5 core that needs no surface; null where it cannot be made. shared: an
/// EGLContext whose objects it shares, or null.
void* make_context(void* display, void* shared = nullptr);

/// What eglGetError has returned.
std::string_view egl_error_name(int error);

}  // namespace diminish::gl
