#include "gl/context.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "diminish/error.h"

namespace diminish::gl {
namespace {

constexpr int major_version = 4;
constexpr int minor_version = 5;

/// Whether a list of extensions, divided by spaces, names one.
bool lists(const char* extensions, std::string_view name) {
  std::string_view rest = extensions ? extensions : "";
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    if (rest.substr(0, end) == name) return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

std::string_view egl_error_name(EGLint error) {
  switch (error) {
    case EGL_BAD_ALLOC:
      return "EGL_BAD_ALLOC";
    case EGL_BAD_ATTRIBUTE:
      return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONFIG:
      return "EGL_BAD_CONFIG";
    case EGL_BAD_MATCH:
      return "EGL_BAD_MATCH";
    case EGL_CONTEXT_LOST:
      return "EGL_CONTEXT_LOST";
    case EGL_NOT_INITIALIZED:
      return "EGL_NOT_INITIALIZED";
    default:
      return "EGL error";
  }
}

std::string_view gl_error_name(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "GL_OUT_OF_MEMORY";
    case GL_CONTEXT_LOST:
      return "GL_CONTEXT_LOST";
    default:
      return "an unknown error";
  }
}

/// libepoxy ends the program where there is no EGL library at all.
void expect_egl_library() {
  static void* const library = dlopen("libEGL.so.1", RTLD_LAZY | RTLD_GLOBAL);
  if (!library) throw Error("gl: expected an EGL library (libEGL.so.1), there is none");
}

/// A place where contexts can be made.
struct Display {
  EGLDisplay display = EGL_NO_DISPLAY;
  bool software = true;
};

/// True also where the platform does not say.
bool draws_in_software(EGLDisplay display) {
  if (!lists(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_EXT_device_query")) return true;
  EGLAttrib device = 0;
  if (eglQueryDisplayAttribEXT(display, EGL_DEVICE_EXT, &device) != EGL_TRUE || device == 0) {
    return true;
  }
  const char* extensions =
      eglQueryDeviceStringEXT(reinterpret_cast<EGLDeviceEXT>(device), EGL_EXTENSIONS);
  return !extensions || lists(extensions, "EGL_MESA_device_software");
}

EGLContext make_context(EGLDisplay display) {
  const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
  if (!lists(extensions, "EGL_KHR_surfaceless_context") || eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) {
    return EGL_NO_CONTEXT;
  }
  EGLConfig config = EGL_NO_CONFIG_KHR;
  if (!lists(extensions, "EGL_KHR_no_config_context")) {
    constexpr std::array<EGLint, 5> wanted = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE,
                                              EGL_OPENGL_BIT, EGL_NONE};
    EGLint count = 0;
    if (eglChooseConfig(display, wanted.data(), &config, 1, &count) != EGL_TRUE || count == 0) {
      return EGL_NO_CONTEXT;
    }
  }
  std::vector<EGLint> attributes = {
      EGL_CONTEXT_MAJOR_VERSION_KHR,   major_version,
      EGL_CONTEXT_MINOR_VERSION_KHR,   minor_version,
      EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
  if (lists(extensions, "EGL_EXT_create_context_robustness")) {
    attributes.insert(attributes.end(),
                      {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET});
  }
  attributes.push_back(EGL_NONE);
  return eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
}

std::optional<Display> usable(EGLDisplay display) {
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) != EGL_TRUE) return {};
  const EGLContext context = make_context(display);
  if (context == EGL_NO_CONTEXT) return {};
  eglDestroyContext(display, context);
  return Display{display, draws_in_software(display)};
}

/// The first display with a hardware driver, else the first.
Display find_display() {
  expect_egl_library();
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!lists(extensions, "EGL_EXT_platform_base")) {
    throw Error("gl: expected an EGL library with EGL_EXT_platform_base, this one has it not");
  }
  std::optional<Display> found;
  const auto consider = [&](EGLDisplay display) {
    const std::optional<Display> other = usable(display);
    if (other && (!found || (found->software && !other->software))) found = other;
    return found && !found->software;
  };
  bool done = false;
  if (lists(extensions, "EGL_MESA_platform_surfaceless")) {
    done = consider(
        eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  }
  const bool has_devices =
      lists(extensions, "EGL_EXT_platform_device") &&
      (lists(extensions, "EGL_EXT_device_enumeration") || lists(extensions, "EGL_EXT_device_base"));
  if (!done && has_devices) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    if (eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count) ==
        EGL_TRUE) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(count) && !done; ++i) {
        done = consider(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
      }
    }
  }
  if (!found) {
    throw Error(
        fmt::format("gl: expected a driver with OpenGL {}.{} core and surfaceless EGL "
                    "contexts, found none",
                    major_version, minor_version));
  }
  return *found;
}

/// Looked for once: displays belong to the process.
const Display& chosen_display() {
  static const Display display = find_display();
  return display;
}

std::string text(GLenum name) {
  const GLubyte* value = glGetString(name);
  return value ? reinterpret_cast<const char*>(value) : "unknown";
}

}  // namespace

struct Context::State {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  Driver driver;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
  }
};

Context::Context() : state_(std::make_unique<State>()) {
  const Display& display = chosen_display();
  state_->display = display.display;
  state_->context = make_context(display.display);
  if (state_->context == EGL_NO_CONTEXT) {
    throw Error(
        fmt::format("gl: no OpenGL context could be made ({})", egl_error_name(eglGetError())));
  }
  const Current current(*this);
  state_->driver = {text(GL_RENDERER), text(GL_VERSION), display.software};
}
Context::~Context() = default;
Context::Context(Context&&) noexcept = default;
Context& Context::operator=(Context&&) noexcept = default;

const Driver& Context::driver() const {
  return state_->driver;
}

void Context::check(const char* doing) const {
  if (glGetGraphicsResetStatus() != GL_NO_ERROR) {
    throw Error(fmt::format("gl: {}: the driver lost the context ({})", doing, driver().name));
  }
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  throw Error(fmt::format("gl: {}: {} ({})", doing, gl_error_name(error), driver().name));
}

Current::Current(const Context& context)
    : display_(context.state_->display),
      previous_display_(eglGetCurrentDisplay()),
      previous_context_(eglGetCurrentContext()),
      previous_draw_(eglGetCurrentSurface(EGL_DRAW)),
      previous_read_(eglGetCurrentSurface(EGL_READ)) {
  eglBindAPI(EGL_OPENGL_API);
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context.state_->context) !=
      EGL_TRUE) {
    throw Error(fmt::format("gl: the context cannot be used ({})", egl_error_name(eglGetError())));
  }
}

Current::~Current() {
  if (previous_context_ == EGL_NO_CONTEXT) {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  } else {
    eglMakeCurrent(previous_display_, previous_draw_, previous_read_, previous_context_);
  }
}

bool has_hardware_driver() {
  try {
    return !Context().driver().software;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace diminish::gl
