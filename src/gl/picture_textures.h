#pragma once

#include <memory>

#include "composite/texture_output.h"
#include "diminish/intrinsics.h"
#include "gl/buffer.h"
#include "gl/context.h"

namespace diminish::gl {

/// A few textures that take frames' pictures in turn, in a context that shares with an
/// application's. Everything `packed` and `drawn` belongs to one picture, until `publish`.
class PictureTextures : public TextureOutput {
 public:
  /// Throws Error if the application's context cannot be shared.
  PictureTextures(const GlSharing& application, const Intrinsics& color);
  ~PictureTextures() override;

  void upload(ImageView<Bgr> picture) override;
  const GlTexture& latest() const override { return latest_; }

  /// What is called with a context that shares with this one current may draw into the textures.
  const Context& context() const { return context_; }

  /// Writes a picture into mapped memory. Needs no context. The GPU must be done with the last
  /// picture.
  void pack(ImageView<Bgr> picture);
  /// Copies the packed picture to the next texture. Needs a context that shares.
  void draw_packed() const;
  /// Draws a region's pixels over it, row by row: blue, green, red and any byte. Needs a context
  /// that shares.
  void draw_region(const Buffer& pixels, const Rect& region) const;
  /// Makes what was drawn the latest picture. Needs a context that shares.
  void publish();

 private:
  struct Resources;

  Context context_;
  Intrinsics color_;
  std::unique_ptr<Resources> resources_;
  GlTexture latest_;
};

}  // namespace diminish::gl
