#pragma once

#include <string>
#include <vector>

#include "gl/buffer.h"
#include "gl/frame_block.h"
#include "gl/frame_upload.h"
#include "gl/pass_timer.h"
#include "gl/program.h"

namespace diminish::gl {

/// Blends what several RGB-D cameras show by the rules of layers.h: what CameraBlender does, in
/// compute passes over pixels and over the cells of a ConfidenceGrid. Nothing is taken out of the
/// cameras' surfaces: a sliver's camera is not among those that see the pixel.
/// Made, used (but for `pack`) and deleted while the context is current.
class CameraBlending {
 public:
  /// What `pack` adds to an upload at most.
  static constexpr std::size_t most_added_bytes =
      most_cameras * sizeof(CameraPlaceBlock) + block_alignment;

  /// seen_files: of the Rasterizer. Throws Error where the driver does not take the shaders.
  CameraBlending(const Rig& rig, const std::vector<std::string>& seen_files);

  /// Adds the cameras' places to the upload, which has packed the frame; needs no context.
  void pack(FrameUpload& upload);
  /// Which cameras the region's pixels are taken from. work: the cameras' WorkBlocks, in order.
  /// What the Rasterizer has found, and both buffers of results (ResultBuffers), are bound.
  void run(const FrameUpload& upload, const Rect& region, const Buffer& work, PassTimer& timer);

 private:
  Program seen_, cells_, trust_, smooth_, choose_;
  Buffer seen_by_, cell_values_;
  std::size_t places_begin_ = 0;
};

}  // namespace diminish::gl
