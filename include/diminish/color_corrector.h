#pragma once

#include <functional>
#include <memory>

#include "diminish/color_map.h"
#include "diminish/export.h"
#include "diminish/image.h"
#include "diminish/reconstruction.h"
#include "diminish/registry.h"

namespace diminish {

/// The input of a colour correction.
struct ColorInputs {
  ImageView<Bgr> camera;  ///< the colour camera's image
  /// The objects' mask in it. `camera` shows the objects there and must not be used.
  const Mask& occlusion;
  const Reconstruction& reconstruction;  ///< drawn in its `region`
  ColorMapsBySource maps;                ///< of the declared model
};

/// Matches the reconstruction's colours to the colour camera's. Registered by name; chosen by the
/// option `color_correct`.
class DIMINISH_EXPORT ColorCorrector {
 public:
  static constexpr const char* kind = "colour correction";
  using Factory = std::function<std::unique_ptr<ColorCorrector>()>;

  /// What other stages need to know about it.
  struct Declaration {
    /// The colour maps to fit before the scene is drawn.
    ColorMapModel maps = ColorMapModel::none;
    /// Whether `correct` only maps colours, with or without a soft membrane. If so, another
    /// implementation (on a GPU) may replace it.
    enum class Rule { own, maps, maps_and_membrane } rule = Rule::own;
    /// The correction to use when time is short; null: this one.
    const char* simpler = nullptr;
  };

  virtual ~ColorCorrector() = default;

  virtual Declaration declaration() const { return {}; }

  /// Writes the corrected colour of every pixel with occlusion and alpha to `picture`, and nothing
  /// else.
  virtual void correct(const ColorInputs& inputs, Image<Bgr>& picture) = 0;
};

}  // namespace diminish
