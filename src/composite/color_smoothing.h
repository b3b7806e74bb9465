#pragma once

#include <array>
#include <cstdint>

#include "core/rows.h"
#include "diminish/image.h"

namespace diminish {

/// Removes the RGB-D cameras' noise. Each seen pixel becomes a mean of its neighbours, weighted by
/// how alike they are (bilateral filter, Tomasi & Manduchi 1998). Likeness is measured in a guide,
/// the slightly blurred picture, so that noise does not decide which pixels are averaged (like the
/// patches of Buades et al. 2005).
class ColorSmoothing {
 public:
  /// Neighbours: a square of 2 reach + 1 pixels without its corners.
  static constexpr int reach = 2;
  static constexpr bool is_neighbour(int dx, int dy) {
    return dx * dx + dy * dy < 2 * reach * reach;
  }

  /// Levels: the sum of the three channels' differences in the guide from which on a neighbour does
  /// not count. Its weight is the difference left to that, divided by weight_part.
  static constexpr int largest_difference = 36;
  static constexpr std::uint32_t weight_part = 4;

  /// Two pixels are as alike one way round as the other, so a pixel is compared with those
  /// neighbours only that come after it.
  struct Offset {
    int x, y;
  };
  static constexpr int later_count = 10;
  static constexpr std::array<Offset, later_count> later{
      {{1, 0}, {2, 0}, {-2, 1}, {-1, 1}, {0, 1}, {1, 1}, {2, 1}, {-1, 2}, {0, 2}, {1, 2}}};

  /// The quotient of two sums of weights, the first multiplied by levels, in 16-bit numbers; exact
  /// to a tenth of a level.
  static constexpr std::uint32_t one = 1U << 19;
  static constexpr std::uint32_t mean(std::uint32_t sum, std::uint32_t weight) {
    const std::uint32_t inverse = (one + weight / 2) / weight;
    return (sum + weight / 2) * inverse / one;
  }

  /// How much of its change a pixel makes: all of it.
  static constexpr int whole_change = 128;

  /// origins: which camera saw each pixel (DiminishedFrame::provenance). Pixels that no RGB-D
  /// camera saw neither change nor count. box: where to look for seen pixels. share: of the change,
  /// 0 to whole_change. Cost: 1 ns per pixel of the box.
  void smooth(const Mask& origins, const Rect& box, int share, Image<Bgr>& picture);

 private:
  void begin(const Rect& box);
  /// values: scratch for the channels.
  void split_row(const Mask& origins, const Image<Bgr>& picture, const Rect& box, int y,
                 Image<std::uint8_t>& values);
  void guide_row(int y, int width);
  /// The weights of some rows' later neighbours.
  using Weights = Image<std::uint8_t>;
  /// Those of row y: each neighbour's in a row of the image, from column `reach` on.
  void compare_row(int y, int width, Weights& weights) const;
  /// weights: of this row, the one above, and so on.
  void smooth_row(const Rect& box, int y, const std::array<const Weights*, reach + 1>& weights,
                  int share, Image<Bgr>& picture) const;

  // These cover the box, and `reach` pixels and a few more around it.
  Mask seen_;                               ///< 255 or 0
  Image<std::int16_t> words_[3];            ///< channels
  Image<std::uint8_t> row_means_[3];        ///< with the neighbours to the left and right
  Image<std::uint8_t> guide_[3];            ///< and above and below
  Image<std::uint8_t> values_[most_bands];  ///< of a row of each band
  Weights weights_[most_bands][reach + 1];  ///< of the last rows of each band
};

}  // namespace diminish
