#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/texture_lookup.h"

namespace diminish {

/// A row of one RGB-D camera's surface, and what blending knows of the camera there.
struct BlendedRow : SurfaceRow {
  /// z in the depth sensor's frame is z_m * (depth_slope + depth_step * i) - depth_offset_m in
  /// pixel i of the row.
  float depth_slope = 1, depth_step = 0, depth_offset_m = 0;
  const float* confidence = nullptr;  ///< of each pixel

  using SurfaceRow::SurfaceRow;
};

/// What choose_two writes, for each pixel of a row.
struct TwoSources {
  std::uint8_t* source;
  float* depth_m;
  std::uint8_t* second_source;
  float* second_depth_m;
  std::uint8_t* share;
};

/// Rules 1 to 3 of blend_layers (layers.h) in vectors of pixels. All three take the rows of the
/// cameras in the order of their turn.

/// 255 where the nearest surface stands alone in front of another camera's, else 0.
void find_lone(const std::vector<BlendedRow>& rows, float agreement_m, int width,
               std::uint8_t* lone);

/// covered: by camera; 0 is written where it does not see the nearest surface.
void mark_uncovered(const std::vector<BlendedRow>& rows, float agreement_m, int width,
                    const std::vector<std::uint8_t*>& covered);

/// The two cameras that are most trusted of those that see the nearest surface.
void choose_two(const std::vector<BlendedRow>& rows, float agreement_m, int width,
                const TwoSources& out);

}  // namespace diminish
