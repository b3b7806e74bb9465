#pragma once

#include <cstdint>

#include "composite/composing_reconstructor.h"
#include "gl/buffer.h"
#include "gl/frame_upload.h"
#include "gl/result_pixel.h"

namespace diminish::gl {

/// What comes back of a frame that was composed on the GPU.
class FrameDownload {
 public:
  /// The objects' pixels, and those of them that no camera saw.
  struct Counts {
    std::uint32_t mask, missing;
  };
  /// What there is: of the region, row by row.
  struct Source {
    const Buffer& picture;  ///< colour, and provenance in the highest byte
    const Buffer& counts;
    const Buffer& surface;  ///< Reconstruction::surface, and ::light above it
    const ResultBuffers& reconstruction;
  };
  /// What of it comes back, besides the counts.
  struct Wanted {
    bool picture;
    bool reconstruction;
  };

  /// While the context is current: room for regions up to `whole`. blends: whether frames may have
  /// second views.
  void reserve(const Rect& whole, bool blends);
  /// Likewise: sends it on its way. upload: of this frame.
  void begin(const Source& source, const Rect& region, const Wanted& wanted,
             const FrameUpload& upload);
  /// When the GPU is done: fills the result's pixel counts and what was wanted. Outside the region
  /// its images are the caller's. What was not wanted of the reconstruction is empty.
  void read(const FrameInputs& inputs, const FrameUpload& upload, DiminishedFrame& result) const;

 private:
  void read_picture(DiminishedFrame& result) const;
  void read_surface(const FrameInputs& inputs, Reconstruction& reconstruction) const;

  Rect region_;
  Wanted wanted_{};
  MappedBuffer downloaded_{MappedBuffer::Use::download};
};

}  // namespace diminish::gl
