#pragma once

#include <Eigen/Core>
#include <vector>

#include "diminish/color_map.h"
#include "diminish/image.h"

namespace diminish {

/// A surface in two cameras: mean colours of an even neighbourhood, in levels.
struct ColorPair {
  Eigen::Vector2f pixel;  ///< in the colour camera's image
  Eigen::Array3f rgbd, camera;
};

/// A robust fit (iteratively reweighted least squares with Tukey's weights): pairs that do not show
/// the same surface, because of occlusion or misregistration, have no influence as long as they are
/// fewer than half.
class ColorMapFit {
 public:
  /// model: not `none`. Terms that too few pairs determine stay near a gain for each channel;
  /// without pairs the map changes nothing. bounds: the picture's. Cost: 0.1 us per pair.
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
