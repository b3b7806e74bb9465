#pragma once

#include <string>
#include <vector>

#include "blend/layers.h"
#include "gl/buffer.h"
#include "gl/frame_block.h"
#include "gl/frame_upload.h"
#include "gl/pass_timer.h"
#include "gl/program.h"

namespace diminish::gl {

/// The files of a pass over what a Rasterizer has found, before its own. seen_files: the
/// Rasterizer's.
std::vector<std::string> files_before(const std::vector<std::string>& seen_files);

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
  /// Whether so few cameras take part that `run` blends them however many see something. Else it
  /// may leave the result to the pass that chooses one, which must come before.
  static bool surely_blends(const FrameUpload& upload) {
    return static_cast<std::size_t>(upload.cameras()) <= blending::most_cameras;
  }
  /// Which cameras the region's pixels are taken from, and their colours. work: the cameras'
  /// WorkBlocks, in order. What the Rasterizer has found, and both buffers of results
  /// (ResultBuffers), are bound.
  void run(const FrameUpload& upload, const Rect& region, const Buffer& work, PassTimer& timer);

 private:
  Program seen_, cells_, trust_, smooth_, choose_, color_;
  Buffer seen_by_, cell_values_;
  std::size_t places_begin_ = 0;
};

}  // namespace diminish::gl
