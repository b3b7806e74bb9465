#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "diminish/image.h"
#include "diminish/reconstruction.h"
#include "diminish/registry.h"

namespace diminish {

/// Brings the reconstruction's colours to the colour camera's. Registered by name; the option
/// `color_correct` chooses.
class ColorCorrector {
 public:
  static constexpr const char* kind = "colour correction";
  using Factory = std::function<std::unique_ptr<ColorCorrector>()>;

  virtual ~ColorCorrector() = default;

  /// Does what needs no drawn scene; called before `correct` with the same frame, while other
  /// threads get ready to draw. samples: Reconstruction::samples.
  virtual void prepare(const Image<Bgr>& /*camera*/, const Mask& /*occlusion*/,
                       const std::vector<SceneSample>& /*samples*/) {}

  /// camera: the colour camera's image. occlusion: the objects' mask in it; `camera` shows the
  /// object there and must not be used. reconstruction: drawn in `reconstruction.region`.
  /// Writes the corrected colour of every pixel with occlusion and alpha to `picture`, and nothing
  /// else.
  virtual void correct(const Image<Bgr>& camera, const Mask& occlusion,
                       const Reconstruction& reconstruction, Image<Bgr>& picture) = 0;
};

}  // namespace diminish
