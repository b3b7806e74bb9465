#pragma once

#include <functional>
#include <memory>

#include "diminish/image.h"
#include "diminish/options.h"
#include "diminish/reconstruction.h"
#include "diminish/registry.h"

namespace diminish {

/// Fills pixels that no camera sees. Registered by name; the option `inpaint` chooses.
class Inpainter {
 public:
  static constexpr const char* kind = "inpainting method";
  using Factory = std::function<std::unique_ptr<Inpainter>()>;

  virtual ~Inpainter() = default;

  /// Writes a colour to every pixel of `picture` where `missing` is not 0, from the other pixels,
  /// none of which shows an object to remove; leaves those alone. reconstruction: what is known of
  /// the surfaces beside the missing pixels. Returns whether the pixels were filled with something
  /// to look at ("none" leaves them black and answers false).
  virtual bool inpaint(const Mask& missing, const Reconstruction& reconstruction,
                       const Options& options, Image<Bgr>& picture) = 0;
};

}  // namespace diminish
