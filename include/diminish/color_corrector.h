#pragma once

#include <functional>
#include <memory>

#include "diminish/color_map.h"
#include "diminish/export.h"
#include "diminish/image.h"
#include "diminish/reconstruction.h"
#include "diminish/registry.h"

namespace diminish {

/// What a colour correction goes by.
struct ColorInputs {
  const Image<Bgr>& camera;  ///< the colour camera's image
  /// The objects' mask in it: `camera` shows the object there and must not be used.
  const Mask& occlusion;
  const Reconstruction& reconstruction;  ///< drawn in its `region`
  ColorMapsBySource maps;                ///< of the declared model
};

/// Brings the reconstruction's colours to the colour camera's. Registered by name; the option
/// `color_correct` chooses.
class DIMINISH_EXPORT ColorCorrector {
 public:
  static constexpr const char* kind = "colour correction";
  using Factory = std::function<std::unique_ptr<ColorCorrector>()>;

  /// What the rest of the frame needs to know of it.
  struct Declaration {
    /// Fitted before the scene is drawn.
    ColorMapModel maps = ColorMapModel::none;
    /// Whether `correct` does nothing but map colours, and add a soft membrane to them. Other
    /// implementations of that, on a GPU, then take its place.
    enum class Rule { own, maps, maps_and_membrane } rule = Rule::own;
    /// The correction to use where time is short; null: this one.
    const char* simpler = nullptr;
  };

  virtual ~ColorCorrector() = default;

  virtual Declaration declaration() const { return {}; }

  /// Writes the corrected colour of every pixel with occlusion and alpha to `picture`, and nothing
  /// else.
  virtual void correct(const ColorInputs& inputs, Image<Bgr>& picture) = 0;
};

}  // namespace diminish
