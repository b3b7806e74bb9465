#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "render/texture_lookup.h"

namespace diminish {

/// A row of one RGB-D camera's surface, and what blending needs to know about the camera.
struct BlendedRow : SurfaceRow {
  /// In pixel i of the row, z in the depth sensor's frame is z_m * (depth_slope + depth_step * i) -
  /// depth_offset_m.
  float depth_slope = 1, depth_step = 0, depth_offset_m = 0;
  const float* confidence = nullptr;  ///< of each pixel

  explicit BlendedRow(const SurfaceRow& surface) : SurfaceRow(surface) {}
};

/// What choose_two writes for each pixel of a row.
struct TwoSources {
  std::uint8_t* source;
  float* depth_m;
  std::uint8_t* second_source;
  float* second_depth_m;
  std::uint8_t* share;

  TwoSources from(int column) const {
    return {source + column, depth_m + column, second_source + column, second_depth_m + column,
            share + column};
  }
  void clear(int width) const {
    for (std::uint8_t* const bytes : {source, second_source, share}) std::fill_n(bytes, width, 0);
    for (float* const depths : {depth_m, second_depth_m}) std::fill_n(depths, width, 0.F);
  }
};

/// Which cameras see the nearest surface: bit k of `seen` stands for the k-th row. lone: 255 where
/// only one camera sees it while another looks past it, else 0. (Rule 1 of layers.h.)
void find_seen(const std::vector<BlendedRow>& rows, float agreement_m, int width,
               std::uint8_t* seen, std::uint8_t* lone);

/// The two most trusted cameras of those that see the nearest surface. (Rule 3.)
void choose_two(const std::vector<BlendedRow>& rows, int width, const std::uint8_t* seen,
                const TwoSources& out);

}  // namespace diminish
