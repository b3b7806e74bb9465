#pragma once

#include <Eigen/Core>
#include <span>

#include "diminish/export.h"

namespace diminish {

/// Brings one RGB-D camera's colours to the colour camera's:
///
///   color = field(x, y) (matrix rgbd + offset),   field = 1 + a X + b Y + c X^2 + d X Y + e Y^2
///
/// The matrix and the offset model white balance, exposure and filters. The field, which is the
/// same for all channels, models both lenses' vignetting. X and Y are pixel coordinates from the
/// picture's centre in half widths.
struct DIMINISH_EXPORT ColorMap {
  Eigen::Matrix3f matrix = Eigen::Matrix3f::Identity();
  Eigen::Vector3f offset = Eigen::Vector3f::Zero();  ///< levels
  Eigen::Matrix<float, 5, 1> field = Eigen::Matrix<float, 5, 1>::Zero();
  Eigen::Vector2f center = Eigen::Vector2f::Zero();
  float half_width = 1;

  /// The field is clamped to these: outside the pairs the polynomial may go anywhere.
  static constexpr float least_field = 0.5F;
  static constexpr float greatest_field = 2;
  float field_at(float x, float y) const;
  Eigen::Array3f operator()(const Eigen::Array3f& rgbd, float x, float y) const;
};

/// The terms that a ColorMap may use.
enum class ColorMapModel {
  none,    ///< colours stay as they are
  affine,  ///< a gain and an offset for each channel
  field    ///< all of it
};

/// By Reconstruction::source: 256 of them.
using ColorMapsBySource = std::span<const ColorMap>;

}  // namespace diminish
