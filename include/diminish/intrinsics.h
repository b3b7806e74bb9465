#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "diminish/export.h"
#include "diminish/image.h"

namespace diminish {

/// How a lens distorts, with OpenCV's coefficients in OpenCV's order.
enum class LensModel : std::uint8_t {
  plumb_bob,  ///< k1, k2, p1, p2, k3: the usual lens
  rational,   ///< k1, k2, p1, p2, k3, k4, k5, k6: wide-angle lenses
  fisheye,    ///< k1, k2, k3, k4 of cv::fisheye (equidistant); up to 85 degrees off the axis
};

/// How many coefficients the model has.
constexpr std::size_t coefficient_count(LensModel model) {
  return model == LensModel::rational ? 8 : model == LensModel::fisheye ? 4 : 5;
}

/// "plumb_bob", "rational" or "fisheye".
DIMINISH_EXPORT const char* name_of(LensModel model);
/// The model of this name, or of ROS's name for it (rational_polynomial, equidistant).
DIMINISH_EXPORT std::optional<LensModel> find_lens_model(const std::string& name);

/// A camera's pinhole and lens, for images as the sensor made them: distorted.
/// Camera frame: x right, y down, z forward. Pixel centres at integer coordinates.
struct Intrinsics {
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  /// As `lens_model` orders them; 0 from `coefficient_count` on.
  std::array<double, 8> distortion{};
  LensModel lens_model = LensModel::plumb_bob;

  Rect bounds() const { return {0, 0, width, height}; }
  friend bool operator==(const Intrinsics&, const Intrinsics&) = default;
};

/// Projection with `Intrinsics`, with what can be computed once kept.
class DIMINISH_EXPORT Lens {
 public:
  Lens() = default;
  explicit Lens(const Intrinsics& intrinsics);

  const Intrinsics& intrinsics() const { return intrinsics_; }

  /// The pixel of a point in the camera frame. Nothing for a point behind the camera or so far
  /// off the axis that the distortion folds back, or 85 degrees and more.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& x_in_camera) const;

  /// The pixel of the ray (x, y, 1); nothing beyond the lens's valid radius.
  std::optional<Eigen::Vector2d> distort(const Eigen::Vector2d& ray) const;

  /// The ray (x, y, 1) of a pixel: the inverse of `distort`, by Newton's method, to 1e-9. A pixel
  /// that no ray reaches gets one whose pixel is another, or that has none.
  Eigen::Vector2d undistort(const Eigen::Vector2d& pixel) const;

  /// The squared radius |(x, y)| of a ray from which on the distortion folds back; 0 if a
  /// coefficient is not finite.
  double max_radius_squared() const { return max_radius_squared_; }

  /// Whether every pixel of the picture has a ray.
  bool covers_picture() const;

 private:
  Intrinsics intrinsics_;
  double max_radius_squared_ = 0;
};

}  // namespace diminish
