#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "diminish/image.h"
#include "geometry/ray_grid.h"
#include "reconstruct/background_planes.h"
#include "reconstruct/depth_noise.h"

// What BackgroundPlanes and CastShadows do to a few pixels of a row, on vector instructions.
namespace diminish::surface_rows {

/// 1 / z of a plane along a row: start + i slope.
struct InverseDepth {
  float start, slope;
};

/// Writes the label of each of `count` pixels: of the plane that it lies on, the last of several;
/// where nothing was measured, of the nearest plane.
/// planes: their labels follow each other from surface_label::first_plane on.
void label(const float* depth_m, int count, const InverseDepth* planes, int plane_count,
           const DepthNoise& tolerance, std::uint8_t* surface);

/// Pixels of a row whose rays are `ray + i slope`, and the light that is missing on the plane
/// there.
struct Shading {
  std::uint8_t label;  ///< the plane's
  BackgroundPlane plane;
  Eigen::Vector2f ray, slope;
  Eigen::Array3f dark, dark_slope;
  /// Shadows fade between this and twice this above the plane, times the noise.
  float fading_height;
};
/// Writes the light that is left on those of `count` pixels that have the plane's label.
void shade(const Shading& shading, const float* depth_m, const std::uint8_t* surface, int count,
           Bgr* light);

}  // namespace diminish::surface_rows
