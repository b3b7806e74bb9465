#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "diminish/image.h"
#include "diminish/tiled_region.h"

namespace diminish {

/// A point on a surface that an RGB-D camera sees and the colour camera may see, too.
struct SceneSample {
  Eigen::Vector3f point_m = Eigen::Vector3f::Zero();  ///< in the colour camera's frame
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();    ///< its place in the colour camera's image
  Eigen::Vector2f texture =
      Eigen::Vector2f::Zero();  ///< its place in the RGB-D camera's colour image
  Bgr color;                    ///< the RGB-D camera's, averaged over the neighbourhood
  std::uint8_t source = 0;      ///< 1 + the RGB-D camera's index
  bool even = false;            ///< the neighbourhood has one colour
};

/// What Reconstruction::surface says of a pixel.
namespace surface_label {
inline constexpr std::uint8_t unknown =
    0;  ///< nothing was measured there, nor is a plane behind it
inline constexpr std::uint8_t first_plane = 1;   ///< and further ones: on a plane of the background
inline constexpr std::uint8_t foreground = 255;  ///< measured, in front of the planes
}  // namespace surface_label

/// What a second RGB-D camera shows of the surfaces that Reconstruction::color shows: to be mixed
/// in once the colours of both were brought to the colour camera's. Known in
/// Reconstruction::region.
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
  SecondView second;           ///< empty where one RGB-D camera drew, or cameras are not blended
  /// In `region`: see surface_label. Where nothing was drawn, the plane that would be seen there.
  /// Empty where planes were not looked for.
  Image<std::uint8_t> surface;
  /// In `region`: the share of the light on the planes that the objects to remove leave, 255: all.
  /// Empty where shadows were not looked for.
  Image<Bgr> light;
  /// Of the objects to remove, in the colour camera's frame, as far as RGB-D cameras see them.
  /// Thin.
  std::vector<Eigen::Vector3f> object_points_m;
  /// Thinly over the whole picture, and not only in `region`: what the RGB-D cameras see of
  /// surfaces, away from objects to remove and from depth edges. A few thousand.
  std::vector<SceneSample> samples;
};

/// The smallest angle between a surface and the line of sight at which SDCT still joins
/// neighbouring depth pixels (Meerits & Saito 2015, equation 2), in degrees: a surface seen more
/// edge-on than this, at this distance, is torn.
/// distance_m: along the line of sight. pixel_angle_deg: between neighbouring depth pixels.
/// threshold_m: the largest depth difference that is joined.
double smallest_visible_surface_angle_deg(double distance_m, double pixel_angle_deg,
                                          double threshold_m);

}  // namespace diminish
