#pragma once

#include <cstdint>

#include "diminish/image.h"

namespace diminish {

/// Values of Surfaces::label.
namespace surface_label {
inline constexpr std::uint8_t unknown =
    0;  ///< nothing was measured there, and no plane is behind it
inline constexpr std::uint8_t first_plane = 1;  ///< and above: on a plane of the background
/// Not measured, but most likely the far side of something measured that stands on a plane.
inline constexpr std::uint8_t standing = 254;
inline constexpr std::uint8_t foreground = 255;  ///< measured, in front of the planes
}  // namespace surface_label

/// The background's planes in the colour camera's view. Images have its size and are known in
/// `region`; they are empty if planes or shadows were not looked for.
struct Surfaces {
  Rect region;
  /// See surface_label. Where nothing was drawn, the plane that would be visible there.
  Image<std::uint8_t> label;
  /// The share of the light on the planes that the objects to remove leave; 255: all of it.
  Image<Bgr> light;
  /// z in the colour camera's frame where the label is `standing`; elsewhere anything. Empty: no
  /// label is.
  Image<float> standing_depth_m;
};

}  // namespace diminish
