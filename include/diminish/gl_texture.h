#pragma once

namespace diminish {

/// An application's OpenGL context, by EGL. It may be current, also in another thread, while a
/// pipeline begins to share its objects; the display must stay initialised as long as that does.
struct GlSharing {
  void* egl_display = nullptr;  ///< EGLDisplay
  void* egl_context = nullptr;  ///< EGLContext of desktop OpenGL, made on it
  int textures = 3;             ///< at least 1: so many pictures exist at a time
};

/// A frame's picture where the application draws. It is the pipeline's and is only read; it is left
/// alone until the pipeline has processed `GlSharing::textures - 1` more frames.
struct GlTexture {
  /// GL_TEXTURE_2D of GL_RGBA8, opaque, one level, linear; the picture's first row has t = 0.
  /// 0: there is no picture.
  unsigned int name = 0;
  int width = 0;   ///< pixels: the colour camera's
  int height = 0;  ///< pixels
  /// GLsync, to be waited for (glWaitSync, on the GPU) before the texture is bound. The pipeline
  /// deletes it when it uses the texture again.
  void* ready = nullptr;
};

}  // namespace diminish
