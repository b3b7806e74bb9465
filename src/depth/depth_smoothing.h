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

  /// measured: what the noise is measured in. given: what is smoothed, of the same size, around
  /// `part`, too. Writes the part of `smoothed`. Where no window fits, and where there is no depth
  /// (0), all stays. Cost: 2 ns per pixel of the part.
  void smooth(ImageView<std::uint16_t> measured, const Image<std::uint16_t>& given,
              const DepthPart& part, Image<std::uint16_t>& smoothed);

 private:
  /// Of a band of rows.
  struct Scratch {
    std::vector<double> columns;
    std::vector<float> row;
    /// The last rows' planes, in columns of the image; then the sums that take the place of depths,
    /// slopes along columns and variances.
    std::array<Image<float>, 4> planes;

    plane_windows::Planes planes_at(int y, int x);
    plane_windows::Sums sums_at(int y, int x);
  };
  float usual_variance(ImageView<std::uint16_t> measured);
  void smooth_band(const Image<std::uint16_t>& given, const DepthPart& part, Rows rows,
                   float half_variance, Image<std::uint16_t>& smoothed);

  float unit_m_;
  std::vector<float> samples_;
  std::array<Scratch, most_bands> scratch_;
};

}  // namespace diminish
