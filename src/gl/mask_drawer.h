#pragma once

#include <memory>

#include "detect/silhouette/disc_dilation.h"
#include "detect/silhouette/mask_drawer.h"
#include "gl/context.h"

namespace diminish::gl {

/// Draws and grows the masks of all images on the GPU: corners go up, one bit per pixel comes down.
class GpuMaskDrawer : public MaskDrawer {
 public:
  /// Throws Error if no driver can do it.
  GpuMaskDrawer();
  ~GpuMaskDrawer() override;

  void draw(std::span<MaskDrawing> drawings) override;

 private:
  struct Resources;

  Context context_;
  std::unique_ptr<Resources> resources_;
  DiscDilation dilation_;  ///< for margins that are too large for the GPU
};

}  // namespace diminish::gl
