#pragma once

#include <vector>

#include "diminish/image.h"
#include "gl/buffer.h"
#include "gl/pass_timer.h"
#include "gl/program.h"

namespace diminish::gl {

/// The inpainting method `surfaces` on the GPU, from buffer to buffer. Reads nothing back and waits
/// for nothing. Create, use and delete it while a context is current. Its pictures are within a
/// level or two of the CPU's (src/inpaint/surface_inpainting.cpp), and the same in every run.
class SurfaceFilling {
 public:
  /// An unsigned integer per pixel, row by row.
  struct Buffers {
    const Buffer& picture;     ///< b, g, r from the lowest byte on; the fourth is lost
    const Buffer& provenance;  ///< in the lowest byte; the others are ignored
    const Buffer& surface;     ///< the region's pixels: Reconstruction::surface in the lowest byte
  };

  /// Throws Error if the driver rejects the shaders.
  SurfaceFilling();

  /// Fills each pixel whose provenance is `inpainted`. If nothing is known to fill from, the pixels
  /// become black and their provenance `unknown`. What shaders wrote to the buffers must have been
  /// made visible to shaders (glMemoryBarrier); what this writes is visible.
  /// stored: the part of the picture that the buffers of colours and provenance hold. region: where
  /// surfaces are known, in the picture; may be empty. window: in the picture; contains the pixels
  /// to fill and one pixel more on each side, except at the border. Allocates if the window or
  /// region is larger than any before. Throws Error if the driver's buffers cannot be that large.
  void fill(const Buffers& buffers, const Rect& stored, const Rect& region, const Rect& window,
            PassTimer& timer);

 private:
  struct Grid {
    Rect rect;
    int first;  ///< where its cells begin
  };
  /// A pass over a grid's cells, or one group for each label.
  struct Step {
    const Program* program;
    std::size_t fine, coarse;  ///< grids
    GLuint across, down;       ///< work groups
    bool by_label;
  };

  void lay_out(const Rect& window);
  void find_holes(const Rect& region, const Rect& window) const;
  void solve(bool is_rest) const;
  void send_rest_sizes() const;

  Program states_, plane_colors_, unite_, rims_, gather_, coarsen_, coarsest_, refine_, finest_;
  Buffer pixels_, parts_, plane_sums_, cells_, work_;
  std::vector<Grid> grids_;  ///< up to the first that one work group solves
  std::vector<Step> steps_;
};

}  // namespace diminish::gl
