#pragma once

#include <cstdint>

#include "diminish/export.h"
#include "diminish/image.h"
#include "diminish/tiled_region.h"

namespace diminish {

/// A second RGB-D camera's view of the surfaces in Reconstruction::color, to be mixed in after both
/// cameras' colours are mapped to the colour camera's. Known in Reconstruction::region.
struct SecondView {
  Image<Bgra> color;           ///< alpha 255 where `share` is not 0, else all 0
  Image<std::uint8_t> source;  ///< 1 + the RGB-D camera's index; 0 where `share` is 0
  Image<std::uint8_t> share;   ///< its weight beside the first camera's, in 1/255; at most half
};

/// The scene behind the objects as the RGB-D cameras see it, drawn from the colour camera's
/// viewpoint. All images have the colour camera's size.
struct Reconstruction {
  TiledRegion region;          ///< the part that was drawn; nothing is known outside it
  Image<Bgra> color;           ///< alpha 255 where a triangle was drawn, else all 0
  Image<float> depth_m;        ///< z in the colour camera's frame; 0 where alpha is 0
  Image<std::uint8_t> source;  ///< 0 where alpha is 0, else 1 + the RGB-D camera's index
  SecondView second;           ///< empty if one RGB-D camera drew, or cameras are not blended
};

/// The smallest angle between a surface and the line of sight at which SDCT still joins
/// neighbouring depth pixels (Meerits & Saito 2015, equation 2), in degrees. A surface that is more
/// edge-on at this distance is torn.
/// distance_m: along the line of sight. pixel_angle_deg: between neighbouring depth pixels.
/// threshold_m: the largest depth difference that is joined.
DIMINISH_EXPORT double smallest_visible_surface_angle_deg(double distance_m, double pixel_angle_deg,
                                                          double threshold_m);

}  // namespace diminish
