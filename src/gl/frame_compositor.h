#pragma once

#include <map>
#include <string>

#include "composite/composing_reconstructor.h"
#include "gl/buffer.h"
#include "gl/composition_block.h"
#include "gl/frame_download.h"
#include "gl/frame_upload.h"
#include "gl/pass_timer.h"
#include "gl/program.h"
#include "gl/result_pixel.h"
#include "gl/surface_filling.h"

namespace diminish::gl {

/// Takes a frame from the reconstruction to the picture on the GPU. Does what the Compositor does,
/// and before that the labels of surfaces and the light on them, each in a compute pass over the
/// region. Create, use (unless stated otherwise) and delete it while the context is current.
class FrameCompositor {
 public:
  /// ComposingReconstructor::takes_over. This rule alone decides what only the CPU does.
  static bool takes_over(Stage stage, const FrameMethods& methods);
  /// Whether the reconstruction is filled too.
  static bool gives_reconstruction(const FrameInputs& inputs, Stage last);
  /// Whether picture and provenance are.
  static bool gives_picture(const FrameInputs& inputs, Stage last);
  /// The most bytes that `pack` adds to an upload.
  static std::size_t most_added_bytes(const Rig& rig);

  explicit FrameCompositor(const Rig& rig);

  /// Adds the frame to the upload, which has packed it; needs no context. last: the stage up to
  /// which the frame is done here.
  void pack(const FrameInputs& inputs, Stage last, FrameUpload& upload);
  /// Call after the upload was sent. reconstruction: of the region, in the upload's order of
  /// cameras. What was requested is then on its way to the CPU.
  void run(const FrameInputs& inputs, const FrameUpload& upload,
           const ResultBuffers& reconstruction, PassTimer& timer);
  /// Fills in the results of `run` when it is done. Needs no context. Outside the region the
  /// result's images are the caller's business.
  void read(const FrameInputs& inputs, const FrameUpload& upload, DiminishedFrame& result) const {
    download_.read(inputs, upload, result);
  }
  /// The region's pixels from `run`: colour, and any byte.
  const Buffer& picture() const { return picture_; }

 private:
  void bind(const FrameUpload& upload, const ResultBuffers& reconstruction) const;
  void run_pass(const Program& program) const;
  void correct_colors(PassTimer& timer) const;
  void finish(const FrameInputs& inputs, const FrameUpload& upload,
              const ResultBuffers& reconstruction, PassTimer& timer);
  const Program& show(const std::string& file);

  CompositionBlock block_{};
  Stage last_ = Stage::drawing;
  std::size_t block_begin_ = 0;
  Rect region_;

  Program label_, light_, sort_, membrane_sums_, membrane_solve_, map_colors_, mix_second_, lift_,
      smooth_guide_, smooth_colors_, row_distances_, restore_, rim_;
  std::map<std::string, Program> shows_;  ///< by the view mode's file
  SurfaceFilling filling_;
  Buffer picture_, values_, state_, surface_, distances_, counts_, nodes_;
  Buffer ray_nodes_;
  BufferTexture ray_texture_;
  FrameDownload download_;
};

}  // namespace diminish::gl
