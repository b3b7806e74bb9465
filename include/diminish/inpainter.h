#pragma once

#include <functional>
#include <memory>

#include "diminish/image.h"
#include "diminish/options.h"
#include "diminish/reconstruction.h"
#include "diminish/registry.h"

namespace diminish {

/// What is to be filled, and what is known of it.
struct Holes {
  const Mask& missing;
  const Mask& occlusion;                 ///< of the objects to remove; holds all of `missing`
  const Reconstruction& reconstruction;  ///< surfaces beside the missing pixels
};

/// Fills pixels that no camera sees. Registered by name; the option `inpaint` chooses.
class Inpainter {
 public:
  static constexpr const char* kind = "inpainting method";
  using Factory = std::function<std::unique_ptr<Inpainter>()>;

  virtual ~Inpainter() = default;

  /// Writes a colour to every pixel of `picture` where `holes.missing` is not 0, from the other
  /// pixels, none of which shows an object to remove; leaves those alone. Returns whether the
  /// pixels were filled with something to look at ("none" leaves them black and answers false).
  virtual bool inpaint(const Holes& holes, const Options& options, Image<Bgr>& picture) = 0;

  /// Whether the reconstruction's `surface` is used; where not, nobody needs to find it.
  virtual bool uses_surfaces() const { return false; }
};

}  // namespace diminish
