#pragma once

#include <Eigen/Core>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// A surface in two cameras: mean colours of an even neighbourhood, in levels.
struct ColorPair {
  Eigen::Vector2f pixel;  ///< in the colour camera's image
  Eigen::Array3f rgbd, camera;
};

/// Brings one RGB-D camera's colours to the colour camera's:
///
///   color = field(x, y) (matrix rgbd + offset),   field = 1 + a X + b Y + c X^2 + d X Y + e Y^2
///
/// The matrix and the offset model white balance, exposure and filters. The field, which is the
/// same for all channels, models both lenses' vignetting. X and Y are pixel coordinates from the
/// picture's centre in half widths.
struct ColorMap {
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
enum class ColorMapModel { affine, field };

/// A robust fit (iteratively reweighted least squares with Tukey's weights): pairs that do not show
/// the same surface, because of occlusion or misregistration, have no influence as long as they are
/// fewer than half.
class ColorMapFit {
 public:
  /// affine: a gain and an offset for each channel. field: all terms of a ColorMap. Terms that too
  /// few pairs determine stay near a gain for each channel; without pairs the map changes nothing.
  /// bounds: the picture's. Cost: 0.1 us per pair.
  ColorMap fit(const std::vector<ColorPair>& pairs, ColorMapModel model, const Rect& bounds);

 private:
  void start_with_gains(const std::vector<ColorPair>& pairs);
  void weigh(const std::vector<ColorPair>& pairs);
  void fit_channels(const std::vector<ColorPair>& pairs, ColorMapModel model);
  void fit_field(const std::vector<ColorPair>& pairs);

  ColorMap map_;
  Eigen::Vector3f gains_;
  std::vector<float> residuals_, weights_, values_;
};

}  // namespace diminish
