#include "gl/context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "diminish/error.h"
#include "gl/display.h"

namespace diminish::gl {
namespace {

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

std::string text(GLenum name) {
  const GLubyte* value = glGetString(name);
  return value ? reinterpret_cast<const char*>(value) : "unknown";
}

}  // namespace

struct Context::State {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  Driver driver;
  /// Shared by all contexts that share objects.
  std::shared_ptr<const int> group = std::make_shared<int>();
  OwnThread thread;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (context == EGL_NO_CONTEXT) return;
    thread.run([&] {
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      eglReleaseThread();
    });
    eglDestroyContext(display, context);
  }

  /// In the thread.
  void begin() {
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE ||
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) != EGL_TRUE) {
      throw Error(Error::device, fmt::format("gl: the context cannot be used ({})",
                                             egl_error_name(eglGetError())));
    }
    driver.name = text(GL_RENDERER);
    driver.version = text(GL_VERSION);
  }
};

namespace {

std::unique_ptr<Context::State> make_state(const Display& display,
                                           EGLContext shared = EGL_NO_CONTEXT) {
  auto state = std::make_unique<Context::State>();
  state->display = display.display;
  state->context = make_context(display.display, shared);
  if (state->context == EGL_NO_CONTEXT) {
    throw Error(Error::device,
                fmt::format("gl: no OpenGL context could be made{} ({})",
                            shared == EGL_NO_CONTEXT ? "" : " that shares with the given one",
                            egl_error_name(eglGetError())));
  }
  state->driver.software = display.software;
  return state;
}

}  // namespace

Context::Context(std::unique_ptr<State> state) : state_(std::move(state)) {
  state_->thread.run([&] { state_->begin(); });
}
Context::Context() : Context(make_state(chosen_display())) {}

Context Context::sharing_with(const GlSharing& application) {
  expect_egl_library();
  EGLint api = EGL_NONE;
  if (!application.egl_display || !application.egl_context ||
      eglQueryContext(application.egl_display, application.egl_context, EGL_CONTEXT_CLIENT_TYPE,
                      &api) != EGL_TRUE) {
    throw Error(Error::device,
                fmt::format("gl: expected an initialised EGLDisplay and an EGLContext made on it{}",
                            application.egl_display && application.egl_context
                                ? fmt::format(" ({})", egl_error_name(eglGetError()))
                                : ", got null"));
  }
  if (api != EGL_OPENGL_API)
    throw Error(Error::device, "gl: expected a context of OpenGL, got another API's");
  const bool software = draws_in_software(application.egl_display);
  return Context(make_state({application.egl_display, software}, application.egl_context));
}

Context Context::sharing_with(const Context& other) {
  const State& state = *other.state_;
  Context context(make_state({state.display, state.driver.software}, state.context));
  context.state_->group = state.group;
  return context;
}

Context::~Context() = default;
Context::Context(Context&&) noexcept = default;
Context& Context::operator=(Context&&) noexcept = default;

const Driver& Context::driver() const {
  return state_->driver;
}

OwnThread& Context::thread() const {
  return state_->thread;
}

bool Context::shares_with(const Context& other) const {
  return state_->group == other.state_->group;
}

void Context::check(const char* doing) const {
  if (glGetGraphicsResetStatus() != GL_NO_ERROR) {
    throw Error(Error::device,
                fmt::format("gl: {}: the driver lost the context ({})", doing, driver().name));
  }
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  throw Error(Error::device,
              fmt::format("gl: {}: {} ({})", doing, gl_error_name(error), driver().name));
}

bool has_hardware_driver() {
  try {
    return !Context().driver().software;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace diminish::gl
