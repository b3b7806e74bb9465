#pragma once

#include <string_view>

namespace diminish::gl {

// EGL's handles are opaque pointers.

/// A display on which contexts can be created.
struct Display {
  void* display = nullptr;  ///< EGLDisplay, initialised
  bool software = true;     ///< the CPU draws
};

/// The first display with a hardware driver, else the first usable one. Throws Error if there is
/// none.
const Display& chosen_display();

/// Throws Error if there is no EGL. Call before any other EGL function.
void expect_egl_library();

/// Also true if the platform does not say.
bool draws_in_software(void* display);

/// Creates an EGLContext of OpenGL 4.5 core that needs no surface; null if that fails. shared: an
/// EGLContext to share objects with, or null.
void* make_context(void* display, void* shared = nullptr);

/// The text of eglGetError's result.
std::string_view egl_error_name(int error);

}  // namespace diminish::gl
