#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// The meaning of a watershed's labels. `Label` is an unsigned integer.
template <class Label>
struct WatershedLabel {
  static constexpr Label unknown = 0;
  static constexpr Label line = std::numeric_limits<Label>::max();
  static constexpr Label queued = line - 1;
  /// Basins are numbered from 1 to this.
  static constexpr Label last_basin = queued - 1;
  static constexpr bool is_basin(Label label) { return static_cast<Label>(label - 1) < last_basin; }
};

/// Divides a picture by flooding from seeds (Meyer 1991). The unknown pixel whose colour differs
/// least from a neighbour's comes next and joins that neighbour's basin. A pixel where two basins
/// meet is on the line between them. Neighbours are left, right, above and below; the difference is
/// the largest over the channels; of equal ones the first reached comes first. These are
/// `cv::watershed`'s rules, and the labels are the same. Reuses its memory.
/// Cost: one pass over the labels, then proportional to the number of unknown pixels.
class Watershed {
 public:
  /// labels: of the picture's size, with basins' numbers, and `unknown` elsewhere. The outermost
  /// pixels become `line`.
  void flood(const Image<Bgr>& picture, Image<std::uint32_t>& labels);
  /// The same for up to 253 basins. Only the unknown pixels and their neighbours need colours.
  void flood(const Image<Bgr>& picture, Image<std::uint8_t>& labels);

  /// The pixels that became `line`, except the outermost ones, as y * width + x.
  const std::vector<int>& line() const { return line_; }

 private:
  template <class Label>
  void flood_labels(const Image<Bgr>& picture, Image<Label>& labels);

  std::vector<int> next_;  ///< of a queued pixel, in its queue
  std::vector<int> line_;
};

}  // namespace diminish
