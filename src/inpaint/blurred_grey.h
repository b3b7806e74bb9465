#pragma once

#include <cstdint>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// A part of a picture in grey, blurred by about a pixel; computed only where it is looked at.
class BlurredGrey {
 public:
  static constexpr float scale = 256;  ///< times the level

  /// Begins with another picture, which must live as long as it is looked at.
  void begin(ImageView<Bgr> picture, const Rect& part);
  /// Makes pixels readable. pixels: counted from the part's first; those beyond are left out.
  void look_at(const Rect& pixels);
  /// A row of the part.
  const std::uint16_t* row(int y) const { return levels_.row(y); }
  std::uint16_t operator()(int x, int y) const { return levels_(x, y); }

 private:
  void blur(const Rect& tile);

  ImageView<Bgr> picture_;
  Rect part_;
  Image<std::uint16_t> levels_;
  Mask is_blurred_;  ///< by tile
};

}  // namespace diminish
