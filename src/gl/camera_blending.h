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

/// The shader files that come before those of a pass over a Rasterizer's results. seen_files: the
/// Rasterizer's.
std::vector<std::string> files_before(const std::vector<std::string>& seen_files);

/// Blends the views of several RGB-D cameras by the rules of layers.h, like CameraBlender, in
/// compute passes over pixels and over the cells of a ConfidenceGrid. Does not change the cameras'
/// surfaces: a sliver's camera simply does not count as seeing the pixel. Create, use (except
/// `pack`) and delete it while the context is current.
class CameraBlending {
 public:
  /// The most bytes that `pack` adds to an upload.
  static constexpr std::size_t most_added_bytes =
      most_cameras * sizeof(CameraPlaceBlock) + block_alignment;

  /// seen_files: the Rasterizer's. Throws Error if the driver rejects the shaders.
  CameraBlending(const Rig& rig, const std::vector<std::string>& seen_files);

  /// Adds the cameras' places to the upload, which has packed the frame. Needs no context.
  void pack(FrameUpload& upload);
  /// Whether there are few enough cameras that `run` always blends them. Otherwise it may leave the
  /// result to the pass that chooses one camera, which must run before.
  static bool surely_blends(const FrameUpload& upload) {
    return static_cast<std::size_t>(upload.cameras()) <= blending::most_cameras;
  }
  /// Finds which cameras the region's pixels are taken from, and their colours. work: the cameras'
  /// WorkBlocks, in order. The Rasterizer's results and both result buffers (ResultBuffers) must be
  /// bound.
  void run(const FrameUpload& upload, const Rect& region, const Buffer& work, PassTimer& timer);

 private:
  Program seen_, cells_, trust_, smooth_, choose_, color_;
  Buffer seen_by_, cell_values_;
  std::size_t places_begin_ = 0;
};

}  // namespace diminish::gl
