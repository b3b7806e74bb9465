#pragma once

#include <cstdint>
#include <vector>

#include "diminish/image.h"
#include "render/surface_buffer.h"

namespace diminish {

/// A row of one RGB-D camera's surface.
struct SurfaceRow {
  const float *inverse_z, *u_over_z, *v_over_z;
  std::uint8_t source;  ///< the camera's name in Reconstruction::source

  SurfaceRow(const SurfaceBuffer& surface, int y, std::uint8_t source_)
      : inverse_z(surface.inverse_z.data() + surface.row(y)),
        u_over_z(surface.u_over_z.data() + surface.row(y)),
        v_over_z(surface.v_over_z.data() + surface.row(y)),
        source(source_) {}

  /// The row from a column on.
  SurfaceRow from(int column) const {
    SurfaceRow rest = *this;
    rest.inverse_z += column;
    rest.u_over_z += column;
    rest.v_over_z += column;
    return rest;
  }
};

/// Which camera each of `width` pixels is taken from, and z there, by the rule of merge_layers. 0
/// where there is no surface.
void choose_source(const std::vector<SurfaceRow>& rows, float agreement_m, int width,
                   std::uint8_t* source, float* depth_m);

/// Looks up the colours of the pixels that are taken from `row` in `texture`, as sample_bilinear
/// does, with alpha 255. Leaves the other pixels alone.
void look_up_colors(const SurfaceRow& row, ImageView<Bgr> texture, int width,
                    const std::uint8_t* source, const float* depth_m, Bgra* colors);

}  // namespace diminish
