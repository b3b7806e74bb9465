#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "diminish/image.h"
#include "diminish/reconstruction.h"

namespace diminish {

/// The colours of the background's planes a little away from the objects to remove: right beside an
/// object lies its contact shadow, which must not be spread over what the object hid.
class PlaneColors {
 public:
  /// Further ones are not known.
  static constexpr int planes = 4;

  /// occlusion: the objects' mask in `picture`.
  void collect(const Mask& occlusion, const Reconstruction& reconstruction,
               const Image<Bgr>& picture);
  /// The mean colour of a plane around a pixel; false where too little of it is seen, or the pixel
  /// is outside the reconstruction's region.
  bool around(int x, int y, std::uint8_t label, Eigen::Array3f& mean) const;

 private:
  static constexpr int cell = 4;   ///< pixels
  static constexpr int gap = 2;    ///< cells around an object that are left out
  static constexpr int reach = 5;  ///< cells

  struct Sum {
    std::uint32_t blue = 0, green = 0, red = 0, count = 0;
  };
  struct Cell {
    bool has_object = false;
    Sum sums[planes];
  };
  Cell& cell_at(int column, int row) {
    return cells_[static_cast<std::size_t>(row * columns_ + column)];
  }
  const Cell& cell_at(int column, int row) const {
    return cells_[static_cast<std::size_t>(row * columns_ + column)];
  }
  bool near_object(int column, int row) const;

  Rect region_;
  int columns_ = 0, rows_ = 0;
  std::vector<Cell> cells_;
};

}  // namespace diminish
