#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "bars/bar.h"
#include "core/channels.h"
#include "diminish/image.h"
#include "diminish/occlusion_masks.h"
#include "geometry/point_projection.h"

namespace diminish {

/// Colours across a bar, pixel by pixel, as the user's camera sees them beside the mask: of the bar
/// itself, and of the wall beside it with the shadows that bars throw on it.
class BarProfile {
 public:
  /// The mask may begin so much earlier or later beside the bar's middle, pixels.
  static constexpr int reach_px = 60;
  /// The bar's own colours are known so far beyond its edges.
  static constexpr float margin_px = 2;

  /// The means of 20 pixels along the bar, from `begin` on, in the direction of `sign`, of which
  /// `shows_bar(x, y)`; beyond the bar, up to `beyond_px` from its edges, `shows_wall(x, y)`. False
  /// if any of the bar's own are not known.
  template <class ShowsBar, class ShowsWall>
  bool collect(ImageView<Bgr> camera, const Mask& occlusion, const Bar& bar, float begin,
               float sign, float beyond_px, const ShowsBar& shows_bar,
               const ShowsWall& shows_wall) {
    constexpr int colors_px = 20;
    constexpr int fewest = colors_px / 4;
    first_ = std::floor(-bar.width_px / 2 - beyond_px);
    colors_.assign(static_cast<std::size_t>(-2 * first_) + 2, Eigen::Array4f::Zero());
    for (std::size_t i = 0; i < colors_.size(); ++i) {
      const float side = first_ + static_cast<float>(i);
      const bool of_bar = is_own(bar, side);
      int count = 0;
      for (int k = 1; k <= reach_px + colors_px && count < colors_px; ++k) {
        const auto [x, y] = nearest_pixel(bar.at(begin + sign * static_cast<float>(k), side));
        if (!camera.bounds().contains(x, y)) break;
        if (occlusion(x, y) != 0 || !(of_bar ? shows_bar(x, y) : shows_wall(x, y))) continue;
        colors_[i].head<3>() += to_channels(camera(x, y));
        ++count;
      }
      if (count >= fewest) {
        colors_[i] /= static_cast<float>(count);
        colors_[i][3] = 1;
      } else if (of_bar) {
        return false;
      } else {
        colors_[i].setZero();
      }
    }
    return true;
  }

  /// Leaves out what is beside the bar and has another hue than at its other end: it is no wall.
  void leave_out_unlike(const BarProfile& other, const Bar& bar) {
    constexpr float unlike = 0.03F;  ///< of a channel's share
    for (std::size_t i = 0; i < colors_.size(); ++i) {
      const Eigen::Array4f& theirs = other.colors_[i];
      if (is_own(bar, first_ + static_cast<float>(i)) || colors_[i][3] == 0 || theirs[3] == 0) {
        continue;
      }
      const auto shares = [](const Eigen::Array4f& color) -> Eigen::Array3f {
        return color.head<3>() / std::max(color.head<3>().sum(), 1.F);
      };
      if ((shares(colors_[i]) - shares(theirs)).abs().maxCoeff() > unlike) colors_[i].setZero();
    }
  }

  /// side: from the bar's middle, as far as was collected. The fourth channel is 1 where it is
  /// known.
  Eigen::Array4f at(float side) const {
    const float position = std::max(side - first_, 0.F);
    const auto first = std::min(static_cast<std::size_t>(position), colors_.size() - 2);
    const float share = position - static_cast<float>(first);
    return colors_[first] + share * (colors_[first + 1] - colors_[first]);
  }

 private:
  static bool is_own(const Bar& bar, float side) {
    return std::abs(side) < bar.width_px / 2 + margin_px + 1;
  }

  float first_ = 0;                     ///< the first colour's side
  std::vector<Eigen::Array4f> colors_;  ///< a fourth channel makes it a vector
};

}  // namespace diminish
