#pragma once

#include <cstddef>
#include <cstdint>

#include "diminish/reconstruction.h"
#include "gl/frame_upload.h"

namespace diminish::gl {

/// A pixel of the reconstruction's region as color.comp leaves it.
struct ResultPixel {
  std::uint8_t b, g, r;
  std::uint8_t place;  ///< among the cameras that take part, from 1 on; 0: nothing
  float depth_m;
};

inline std::size_t pixels_of(const Rect& region) {
  return static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
}

/// Writes colour, depth and source of the reconstruction's region. upload: of this frame.
void unpack(const ResultPixel* pixel, const FrameUpload& upload, Reconstruction& reconstruction);

}  // namespace diminish::gl
