#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "detect/silhouette/polygons.h"
#include "diminish/image.h"
#include "diminish/registry.h"

namespace diminish {

/// What is left to do for one image's mask.
struct MaskDrawing {
  const Polygons* polygons = nullptr;  ///< to be drawn
  int margin_px = 0;                   ///< by which the mask grows afterwards
  bool is_blank = true;                ///< no pixel is set yet
  Rect part;                           ///< nothing is set outside it, now or before the mask grows
  Mask* mask = nullptr;                ///< 0 and 255; of the image's size
  /// By object: set to 1 where one of its polygons covers a pixel.
  std::vector<std::uint8_t> covers;
};

/// Finishes masks: draws polygons into them and grows them by discs (DiscDilation). All
/// implementations set the same pixels. Registered by name: "cpu", "gl".
class MaskDrawer {
 public:
  static constexpr const char* kind = "drawing of masks";
  using Factory = std::function<std::unique_ptr<MaskDrawer>()>;

  virtual ~MaskDrawer() = default;

  /// All drawings have the same number of objects. Throws Error if a GPU fails; the masks are then
  /// unchanged.
  virtual void draw(std::span<MaskDrawing> drawings) = 0;
};

}  // namespace diminish
