#pragma once

#include <cstdint>

#include "composite/composing_reconstructor.h"
#include "gl/buffer.h"
#include "gl/frame_upload.h"
#include "gl/result_pixel.h"

namespace diminish::gl {

/// Downloads a frame that was composed on the GPU.
class FrameDownload {
 public:
  /// The number of the objects' pixels, and of those that no camera saw.
  struct Counts {
    std::uint32_t mask, missing;
  };
  /// The results on the GPU, for the region, row by row.
  struct Source {
    const Buffer& picture;  ///< colour, and provenance in the highest byte
    const Buffer& counts;
    const Buffer& surface;  ///< Surfaces::label, and ::light above it
    const ResultBuffers& reconstruction;
  };
  /// What to download besides the counts.
  struct Wanted {
    bool picture;
    bool reconstruction;
  };

  /// Reserves memory for regions up to `whole`. The context must be current. blends: whether frames
  /// may have second views.
  void reserve(const Rect& whole, bool blends);
  /// Starts the download. The context must be current. upload: this frame's.
  void begin(const Source& source, const Rect& region, const Wanted& wanted,
             const FrameUpload& upload);
  /// Call when the GPU is done. Fills the result's pixel counts and what was wanted. Outside the
  /// region its images are the caller's business. Unwanted images of the reconstruction become
  /// empty.
  void read(const FrameInputs& inputs, const FrameUpload& upload, DiminishedFrame& result) const;

 private:
  void read_picture(DiminishedFrame& result) const;
  void read_surfaces(const FrameInputs& inputs, Surfaces& surfaces) const;

  Rect region_;
  Wanted wanted_{};
  MappedBuffer downloaded_{MappedBuffer::Use::download};
};

}  // namespace diminish::gl
