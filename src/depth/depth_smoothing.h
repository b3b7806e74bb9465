#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/rows.h"
#include "depth/depth_part.h"
#include "depth/plane_windows.h"
#include "diminish/image.h"

namespace diminish {

/// Takes the noise out of depth images: seen from the side, noise in depth becomes noise in place.
/// A plane is fitted to the 49 pixels around each pixel. Each pixel becomes the mean of what the
/// planes of all windows that hold it say, as guided filters do (He et al. 2013), but weighted: a
/// window that holds an edge deviates from its plane by more than the noise and hardly counts. So
/// edges stay sharp. How much noise there is is measured in each image: half of all windows deviate
/// by less.
class DepthSmoothing {
 public:
  explicit DepthSmoothing(float depth_unit_m) : unit_m_(depth_unit_m) {}

  /// What a pixel becomes depends on pixels so far away.
  static constexpr int reach = 2 * plane_windows::reach;

  /// measured: what the noise is measured in. Changes `part` of `depth`, of the same size. Where no
  /// window fits, and where there is no depth (0), all stays. Cost: 2 ns per pixel of the part.
  void smooth(ImageView<std::uint16_t> measured, const DepthPart& part,
              Image<std::uint16_t>& depth);

 private:
  struct Scratch {
    std::vector<double> columns;
    std::vector<float> row;
  };
  plane_windows::Planes planes(int y, int x);
  plane_windows::Sums sums(int y, int x);
  float usual_variance(ImageView<std::uint16_t> measured);

  float unit_m_;
  // Sums take the place of the depths, slopes along columns and variances that they come from.
  Image<float> depth_, slope_x_, slope_y_, variance_;
  std::vector<float> samples_;
  std::array<Scratch, most_bands> scratch_;
};

}  // namespace diminish
