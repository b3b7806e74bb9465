#pragma once

#include <memory>
#include <optional>

#include "composite/texture_output.h"
#include "diminish/diminished_frame.h"
#include "diminish/intrinsics.h"

namespace diminish {

/// A frame's picture as a texture, where an application wants one.
class FrameTexture {
 public:
  /// nullopt: no longer. Throws Error where there is no OpenGL, or the context cannot be shared.
  void want(const std::optional<GlSharing>& application, const Intrinsics& color);

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
