#pragma once

#include <Eigen/Core>
#include <array>
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
  /// Pairs that are worked on together; those after the last have no weight.
  static constexpr int lanes = 8;
  using Lanes = Eigen::Array<float, lanes, 1>;
  struct Pairs {
    std::array<Lanes, 3> rgbd, camera;  ///< channels
    std::array<Lanes, 5> terms;         ///< of the field
    Lanes residual, weight;
    int count;
  };
  void collect(const std::vector<ColorPair>& pairs);
  void start_with_gains(const std::vector<ColorPair>& pairs);
  void weigh();
  void fit_channels(ColorMapModel model);
  void fit_field();
  Lanes field_of(const Pairs& pairs) const;
  /// By matrix and offset.
  Lanes flat(const Pairs& pairs, int channel) const;

  ColorMap map_;
  Eigen::Vector3f gains_;
  std::vector<Pairs> pairs_;
  std::vector<float> values_;
};

}  // namespace diminish
