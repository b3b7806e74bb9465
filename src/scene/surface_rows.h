#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "depth/depth_noise.h"
#include "diminish/image.h"
#include "diminish/surfaces.h"

// The row kernels of BackgroundPlanes and CastShadows, on vector instructions.
namespace diminish::surface_rows {

/// 1 / z of a plane along a row: start + i slope.
struct InverseDepth {
  float start, slope;
};
constexpr int most_planes = 3;
/// Some pixels of a row, one after the other, along which the planes' 1 / z are linear.
struct Segment {
  int count;
  std::array<InverseDepth, most_planes> planes;
};

/// Writes the label of each pixel of consecutive segments: of the plane that it lies on (the last
/// of several), or where nothing was measured, of the nearest plane. The planes' labels are
/// consecutive from surface_label::first_plane on.
void label(const float* depth_m, std::span<const Segment> segments, int plane_count,
           const DepthNoise& tolerance, std::uint8_t* surface);

/// A shadow on some pixels of a row.
struct Shading {
  std::uint8_t label;  ///< the plane's
  /// A point's height above the plane is z times what `first` says, minus this.
  float distance_m;
  /// Shadows fade between this and twice this above the plane, times the noise.
  float fading_height;
  /// The missing light in three channels and the height per metre of z; the second value is their
  /// step from pixel to pixel.
  Eigen::Array4f first, slope;
};
/// Writes the light that is left on `count` pixels: all of it, except on those with a shading's
/// label.
void shade(std::span<const Shading> shadings, const float* depth_m, const std::uint8_t* surface,
           int count, Bgr* light);

}  // namespace diminish::surface_rows
