// Pictures as textures in your own OpenGL context: nothing is read back.
//   draw_texture RECORDING
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <cstdio>
#include <exception>

#include "diminish/diminish.h"

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: draw_texture RECORDING\n");
    return 2;
  }
  // A program with a window has these three already (GLFW: glfwGetEGLDisplay, glfwGetEGLContext).
  const EGLDisplay display =
      eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (!eglInitialize(display, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API)) return 1;
  constexpr EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5,
                                   EGL_NONE};
  const EGLContext context =
      eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) return 1;
  constexpr int width = 640;
  constexpr int height = 360;
  GLuint image = 0;
  GLuint frames[2] = {};  // the window's, and the picture's
  glCreateRenderbuffers(1, &image);
  glNamedRenderbufferStorage(image, GL_RGBA8, width, height);
  glCreateFramebuffers(2, frames);
  glNamedFramebufferRenderbuffer(frames[0], GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, image);

  const diminish::Recording recording = diminish::load_recording(argv[1]);
  diminish::Options options;
  options.backend = "gl";
  const auto source = diminish::open_recording(recording, options);
  diminish::Pipeline pipeline(recording.rig, recording.scene, options);
  pipeline.want_texture(diminish::GlSharing{display, context});
  pipeline.want_reconstruction(false);
  diminish::FrameSet frame;
  diminish::DiminishedFrame result;
  while (source->next(frame)) {
    pipeline.process(frame, result);
    const diminish::GlTexture& picture = pipeline.texture();
    if (picture.name == 0) continue;
    glWaitSync(static_cast<GLsync>(picture.ready), 0, GL_TIMEOUT_IGNORED);
    glNamedFramebufferTexture(frames[1], GL_COLOR_ATTACHMENT0, picture.name, 0);
    // OpenGL's windows begin at the bottom.
    glBlitNamedFramebuffer(frames[1], frames[0], 0, 0, picture.width, picture.height, 0, height,
                           width, 0, GL_COLOR_BUFFER_BIT, GL_LINEAR);
    // eglSwapBuffers(display, window);
    std::printf("%s: drawn, %dx%d, %zu pixels replaced\n", result.name.c_str(), picture.width,
                picture.height, result.report.mask_pixels);
  }
  return glGetError() == GL_NO_ERROR ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
