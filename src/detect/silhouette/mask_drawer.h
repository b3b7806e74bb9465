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

/// What one image's mask still needs.
struct MaskDrawing {
  const Polygons* polygons = nullptr;  ///< to be drawn
  int margin_px = 0;                   ///< by which the mask grows then
  bool is_blank = true;                ///< nothing is set in it yet
  Rect part;             ///< outside of which nothing is set, or will be before it grows
  Mask* mask = nullptr;  ///< 0 and 255; of the image's size
  /// By object, 0: becomes 1 where a polygon of its covers a pixel.
  std::vector<std::uint8_t> covers;
};

/// Finishes masks: draws polygons into them, and grows them by discs (DiscDilation). Any
/// implementation sets the same pixels. Registered by name: "cpu", "gl".
class MaskDrawer {
 public:
  static constexpr const char* kind = "drawing of masks";
  using Factory = std::function<std::unique_ptr<MaskDrawer>()>;

  virtual ~MaskDrawer() = default;

  /// All drawings have the same number of objects. Throws Error where a GPU fails: the masks are
  /// then as they were.
  virtual void draw(std::span<MaskDrawing> drawings) = 0;
};

}  // namespace diminish
