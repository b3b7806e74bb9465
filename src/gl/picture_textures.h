#pragma once

#include <memory>

#include "composite/texture_output.h"
#include "diminish/intrinsics.h"
#include "gl/buffer.h"
#include "gl/context.h"

namespace diminish::gl {

/// A few textures, which frames' pictures go to in turn, in a context that shares with an
/// application's. What is `packed` and `drawn` belongs to one picture; `publish` ends it.
class PictureTextures : public TextureOutput {
 public:
  /// Throws Error where the application's context cannot be shared.
  PictureTextures(const GlSharing& application, const Intrinsics& color);
  ~PictureTextures() override;

  void upload(const Image<Bgr>& picture) override;
  const GlTexture& latest() const override { return latest_; }

  /// What is called with a context that shares with this one current may draw into the textures.
  const Context& context() const { return context_; }

  /// Writes a picture into mapped memory; needs no context. The GPU must be done with the last.
  void pack(const Image<Bgr>& picture);
  /// In a context that shares: what is packed, to the next texture.
  void draw_packed() const;
  /// Likewise, over it: a region's pixels, row by row; blue, green, red and any byte.
  void draw_region(const Buffer& pixels, const Rect& region) const;
  /// Likewise: what was drawn is the latest picture.
  void publish();

 private:
  struct Resources;

  Context context_;
  Intrinsics color_;
  std::unique_ptr<Resources> resources_;
  GlTexture latest_;
};

}  // namespace diminish::gl
