#pragma once

#include <functional>
#include <memory>
#include <span>

#include "diminish/export.h"
#include "diminish/image.h"
#include "diminish/options.h"
#include "diminish/registry.h"
#include "diminish/rim_line.h"
#include "diminish/surfaces.h"

namespace diminish {

/// The pixels to fill, and what is known about them.
struct Holes {
  const Mask& missing;
  const Mask& occlusion;     ///< the objects to remove; contains all of `missing`
  const Surfaces& surfaces;  ///< empty unless declared to be used
  /// z of what was drawn, in the colour camera's frame; 0: nothing was. Known in
  /// `surfaces.region`. Empty: not known.
  ImageView<float> depth_m = {};
  /// The straight edges that run into the mask, the strongest first. Empty unless declared to be
  /// used.
  std::span<const RimLine> lines = {};
  /// The box of `occlusion`. Empty: not known.
  Rect objects = {};

  /// A part of the picture that contains all of `missing`.
  Rect part() const { return objects.empty() ? missing.bounds() : objects; }
};

/// Fills pixels that no camera sees. Registered by name; chosen by the option `inpaint`.
class DIMINISH_EXPORT Inpainter {
 public:
  static constexpr const char* kind = "inpainting method";
  using Factory = std::function<std::unique_ptr<Inpainter>()>;

  /// What other stages need to know about it.
  struct Declaration {
    /// Whether it uses `Holes::surfaces`. If not, they need not be computed.
    bool uses_surfaces = false;
    /// Whether it uses `Holes::lines`.
    bool uses_lines = false;
    /// Whether what it fills on planes is to get their grain afterwards. Needs `uses_surfaces`.
    bool wants_grain = false;
    /// The rule that it follows, if it is one of these. Another implementation (on a GPU) may then
    /// replace it.
    enum class Rule {
      own,
      by_surface,     ///< each plane from its own pixels (src/inpaint/surface_rules.h)
      leaves_unknown  ///< nothing is filled
    } rule = Rule::own;
    /// The method to use when time is short; null: this one.
    const char* simpler = nullptr;
  };

  virtual ~Inpainter() = default;

  virtual Declaration declaration() const { return {}; }

  /// Writes a colour to every pixel of `picture` where `holes.missing` is not 0, using the other
  /// pixels, none of which shows an object to remove. Leaves those unchanged. Returns whether the
  /// pixels were filled ("none" leaves them black and returns false).
  virtual bool inpaint(const Holes& holes, const Options& options, Image<Bgr>& picture) = 0;
};

}  // namespace diminish
