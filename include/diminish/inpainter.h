#pragma once

#include <functional>
#include <memory>

#include "diminish/export.h"
#include "diminish/image.h"
#include "diminish/options.h"
#include "diminish/registry.h"
#include "diminish/surfaces.h"

namespace diminish {

/// What is to be filled, and what is known of it.
struct Holes {
  const Mask& missing;
  const Mask& occlusion;     ///< of the objects to remove; holds all of `missing`
  const Surfaces& surfaces;  ///< empty unless declared to be used
};

/// Fills pixels that no camera sees. Registered by name; the option `inpaint` chooses.
class DIMINISH_EXPORT Inpainter {
 public:
  static constexpr const char* kind = "inpainting method";
  using Factory = std::function<std::unique_ptr<Inpainter>()>;

  /// What the rest of the frame needs to know of it.
  struct Declaration {
    /// Whether `Holes::surfaces` is used; where not, nobody needs to find it.
    bool uses_surfaces = false;
    /// Which of these it follows. Other implementations of that, on a GPU, then take its place.
    enum class Rule {
      own,
      by_surface,     ///< each plane from its own pixels (src/inpaint/surface_rules.h)
      leaves_unknown  ///< nothing is filled
    } rule = Rule::own;
    /// The method to use where time is short; null: this one.
    const char* simpler = nullptr;
  };

  virtual ~Inpainter() = default;

  virtual Declaration declaration() const { return {}; }

  /// Writes a colour to every pixel of `picture` where `holes.missing` is not 0, from the other
  /// pixels, none of which shows an object to remove; leaves those alone. Returns whether the
  /// pixels were filled with something to look at ("none" leaves them black and answers false).
  virtual bool inpaint(const Holes& holes, const Options& options, Image<Bgr>& picture) = 0;
};

}  // namespace diminish
