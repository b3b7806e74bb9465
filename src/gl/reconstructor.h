#pragma once

#include <memory>
#include <string>
#include <vector>

#include "composite/composing_reconstructor.h"
#include "gl/buffer.h"
#include "gl/context.h"
#include "gl/frame_upload.h"
#include "gl/pass_timer.h"
#include "gl/program.h"

namespace diminish::gl {

/// Binds a camera's WorkBlock for shaders (triangles.glsl).
inline void bind_work(const Buffer& work, int camera) {
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, 4, work.name(),
                    static_cast<GLintptr>(camera) * static_cast<GLintptr>(sizeof(WorkBlock)),
                    sizeof(WorkBlock));
}

/// A way to find what is seen in each pixel. Create, use and delete it while the context is
/// current.
class Rasterizer {
 public:
  virtual ~Rasterizer() = default;

  /// The shader files that define kept_inverse_z_at(), seen_place() and seen_color() for later
  /// passes.
  virtual std::vector<std::string> seen_files() const = 0;
  /// Finds what the cameras see in the bound frame. work: an empty WorkBlock for each camera.
  virtual void draw(const FrameUpload& upload, const Rect& region, const Buffer& work,
                    PassTimer& timer) = 0;
  /// Binds what these functions read.
  virtual void bind_seen() const = 0;
};

/// The frame around a Rasterizer: one upload, the cameras merged or blended by the rules of
/// layers.h, the way to the picture if wanted (FrameCompositor), one download.
class GlReconstructor : public ComposingReconstructor {
 public:
  using MakeRasterizer =
      std::function<std::unique_ptr<Rasterizer>(const Rig& rig, const FrameUpload& upload)>;

  /// Throws Error if no driver can do it.
  GlReconstructor(const Rig& rig, const MakeRasterizer& make_rasterizer);
  ~GlReconstructor() override;

  void reconstruct(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                   const OcclusionMasks& masks, const TiledRegion& region, const Options& options,
                   Reconstruction& reconstruction) override;
  bool takes_over(Stage stage, const FrameMethods& methods) const override;
  void compose(const FrameInputs& inputs, Stage last, DiminishedFrame& result) override;
  std::string mask_drawer() const override;
  const std::string& device() const override { return device_; }
  const std::vector<GpuPass>& gpu_passes() const override { return passes_; }

 private:
  struct Resources;

  void prepare_blending();
  void make_resources();
  void share_with(const Context& other);
  void draw(const Rect& region);

  Rig rig_;
  MakeRasterizer make_rasterizer_;
  Context context_;
  std::string device_;
  std::vector<GpuPass> passes_;
  std::unique_ptr<Resources> resources_;
};

}  // namespace diminish::gl
