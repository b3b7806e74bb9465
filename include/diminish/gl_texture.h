#pragma once

namespace diminish {

/// An application's OpenGL context, through EGL. While a pipeline starts to share its objects, it
/// may be current, also in another thread. The display must stay initialised as long as the
/// pipeline shares.
struct GlSharing {
  void* egl_display = nullptr;  ///< EGLDisplay
  void* egl_context = nullptr;  ///< EGLContext of desktop OpenGL, made on it
  int textures = 3;             ///< at least 1: the number of pictures that exist at a time
};

/// A frame's picture as a texture for the application. It belongs to the pipeline and may only be
/// read. It stays unchanged until the pipeline has processed `GlSharing::textures - 1` more frames.
struct GlTexture {
  /// GL_TEXTURE_2D of GL_RGBA8, opaque, one level, linear; the picture's first row has t = 0. 0: no
  /// picture.
  unsigned int name = 0;
  int width = 0;   ///< pixels: the colour camera's
  int height = 0;  ///< pixels
  /// GLsync. Wait for it (glWaitSync, on the GPU) before binding the texture. The pipeline deletes
  /// it when it reuses the texture.
  void* ready = nullptr;
};

}  // namespace diminish
