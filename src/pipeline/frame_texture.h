#pragma once

#include <memory>
#include <utility>

#include "composite/texture_output.h"
#include "diminish/diminished_frame.h"
#include "diminish/intrinsics.h"

namespace diminish {

/// Textures that an application shares. Throws Error where there is no OpenGL, or the context
/// cannot be shared.
std::unique_ptr<TextureOutput> make_texture_output(const GlSharing& application,
                                                   const Intrinsics& color);

/// A frame's picture as a texture, where an application wants one.
class FrameTexture {
 public:
  /// output: null where nobody wants a texture any longer.
  void put_to(std::unique_ptr<TextureOutput> output) {
    texture_ = {};
    output_ = std::move(output);
  }

  /// Where a GPU puts the picture; null where nobody wants a texture.
  TextureOutput* output() const { return output_.get(); }
  void begin_frame() { texture_ = {}; }
  /// drawn: whether a GPU has put the picture there. Else it is the result's, and uploaded, which
  /// is reported.
  void finish_frame(bool drawn, DiminishedFrame& result);
  const GlTexture& texture() const { return texture_; }

 private:
  std::unique_ptr<TextureOutput> output_;
  GlTexture texture_;
};

}  // namespace diminish
