#pragma once

#include <Eigen/Core>
#include <array>
#include <bitset>
#include <optional>
#include <vector>

#include "diminish/image.h"
#include "pose/aruco.h"

namespace diminish {

/// Reads markers of one dictionary.
class MarkerCode {
 public:
  explicit MarkerCode(const MarkerDictionary& dictionary);

  /// The number of cells along a side, including the black border.
  int modules() const { return bits_ + 2; }

  struct Reading {
    int id;
    int top_left;  ///< which of the corners is the marker's own top left
  };
  /// The marker in a quadrilateral (clockwise) of the picture. Nothing if its cells are not a code
  /// of the dictionary, apart from errors that the dictionary can correct.
  std::optional<Reading> read(ImageView<Bgr> image,
                              const std::array<Eigen::Vector2d, 4>& corners) const;

 private:
  static constexpr int max_modules = 9;
  using Bits = std::bitset<64>;

  int bits_;
  int max_errors_;
  std::vector<Bits> codes_;  ///< by id, row by row
};

}  // namespace diminish
