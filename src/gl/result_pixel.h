#pragma once

#include <cstddef>
#include <cstdint>

#include "diminish/reconstruction.h"
#include "gl/buffer.h"
#include "gl/frame_upload.h"
#include "gl/pixels_of.h"

namespace diminish::gl {

/// A pixel of the reconstruction's region, as color.comp writes it.
struct ResultPixel {
  std::uint8_t b, g, r;
  std::uint8_t place;  ///< among the cameras that take part, from 1 on; 0: nothing
  float depth_m;
};

/// A second camera's view of the same surface, if cameras are blended.
struct SecondPixel {
  std::uint8_t b, g, r;
  std::uint8_t place;   ///< as above; 0: none
  std::uint32_t share;  ///< SecondView::share
};

static_assert(sizeof(ResultPixel) == 8 && sizeof(SecondPixel) == 8);

/// Both of the region's pixels.
struct ResultBuffers {
  Buffer first;   ///< ResultPixels
  Buffer second;  ///< SecondPixels; meaningless if the upload does not blend
};

/// Writes colour, depth and source of the reconstruction's region. If the upload blends, also
/// writes the second view, whose images have the same size; it becomes empty if all its pixels are.
/// upload: this frame's.
void unpack(const ResultPixel* pixel, const SecondPixel* second, const FrameUpload& upload,
            Reconstruction& reconstruction);

}  // namespace diminish::gl
