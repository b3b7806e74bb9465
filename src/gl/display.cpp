#include "gl/display.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <fmt/format.h>

#include <array>
#include <optional>
#include <vector>

#include "diminish/error.h"

namespace diminish::gl {
namespace {

constexpr int major_version = 4;
constexpr int minor_version = 5;

/// Whether a space-separated list of extensions names one.
bool lists(const char* extensions, std::string_view name) {
  std::string_view rest = extensions ? extensions : "";
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    if (rest.substr(0, end) == name) return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

}  // namespace

std::string_view egl_error_name(EGLint error) {
  switch (error) {
    case EGL_BAD_ALLOC:
      return "EGL_BAD_ALLOC";
    case EGL_BAD_ATTRIBUTE:
      return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONTEXT:
      return "EGL_BAD_CONTEXT";
    case EGL_BAD_DISPLAY:
      return "EGL_BAD_DISPLAY";
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

/// libepoxy aborts the program if there is no EGL library at all.
void expect_egl_library() {
  static void* const library = dlopen("libEGL.so.1", RTLD_LAZY | RTLD_GLOBAL);
  if (!library)
    throw Error(Error::device, "gl: expected an EGL library (libEGL.so.1), there is none");
}

bool draws_in_software(void* display) {
  if (!lists(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_EXT_device_query")) return true;
  EGLAttrib device = 0;
  if (eglQueryDisplayAttribEXT(display, EGL_DEVICE_EXT, &device) != EGL_TRUE || device == 0) {
    return true;
  }
  const char* extensions =
      eglQueryDeviceStringEXT(reinterpret_cast<EGLDeviceEXT>(device), EGL_EXTENSIONS);
  return !extensions || lists(extensions, "EGL_MESA_device_software");
}

void* make_context(void* display, void* shared) {
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
  const std::size_t count = attributes.size();
  attributes.push_back(EGL_NONE);
  if (lists(extensions, "EGL_EXT_create_context_robustness")) {
    attributes.insert(attributes.begin() + static_cast<std::ptrdiff_t>(count),
                      {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET});
    const EGLContext context = eglCreateContext(display, config, shared, attributes.data());
    if (context != EGL_NO_CONTEXT) return context;
    // Contexts that share must agree in this (EGL 1.5, 3.7.1).
    attributes[count] = EGL_NONE;
  }
  return eglCreateContext(display, config, shared, attributes.data());
}

namespace {

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
    throw Error(Error::device,
                "gl: expected an EGL library with EGL_EXT_platform_base, this one has it not");
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
    throw Error(Error::device,
                fmt::format("gl: expected a driver with OpenGL {}.{} core and surfaceless EGL "
                            "contexts, found none",
                            major_version, minor_version));
  }
  return *found;
}

}  // namespace

const Display& chosen_display() {
  // Searched once: displays belong to the process.
  static const Display display = find_display();
  return display;
}

}  // namespace diminish::gl
