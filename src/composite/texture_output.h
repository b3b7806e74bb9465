#pragma once

#include "diminish/gl_texture.h"
#include "diminish/image.h"

namespace diminish {

/// The textures that an application gets frames' pictures in.
class TextureOutput {
 public:
  virtual ~TextureOutput() = default;

  /// Uploads a picture that the CPU made. Throws Error if the GPU fails.
  virtual void upload(ImageView<Bgr> picture) = 0;
  /// The last picture.
  virtual const GlTexture& latest() const = 0;
};

}  // namespace diminish
