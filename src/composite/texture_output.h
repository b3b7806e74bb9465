#pragma once

#include "diminish/gl_texture.h"
#include "diminish/image.h"

namespace diminish {

/// Where frames' pictures go when an application wants them as textures.
class TextureOutput {
 public:
  virtual ~TextureOutput() = default;

  /// For a picture that the processor has made. Throws Error where the GPU fails.
  virtual void upload(const Image<Bgr>& picture) = 0;
  /// The last picture.
  virtual const GlTexture& latest() const = 0;
};

}  // namespace diminish
