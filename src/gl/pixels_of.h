#pragma once

#include <cstddef>

#include "diminish/image.h"

namespace diminish::gl {

/// The number of pixels.
inline std::size_t pixels_of(const Rect& region) {
  return static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
}

}  // namespace diminish::gl
