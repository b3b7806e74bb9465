#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "diminish/image.h"
#include "diminish/surfaces.h"

namespace diminish {

/// The colours of the background's planes a little away from the objects to remove. Right beside an
/// object lies its contact shadow, which must not spread over what the object hid.
class PlaneColors {
 public:
  /// More planes are ignored.
  static constexpr int planes = 4;
  static constexpr int cell = 4;   ///< pixels
  static constexpr int step = 2;   ///< pixels; every other row and column is enough
  static constexpr int gap = 2;    ///< cells around an object that are skipped
  static constexpr int reach = 5;  ///< cells
  static constexpr int fewest = 24 / (step * step);  ///< fewest pixels for a mean

  /// occlusion: the objects' mask in `picture`.
  void collect(const Mask& occlusion, const Surfaces& surfaces, const Image<Bgr>& picture);
  /// The mean colour of a plane around a pixel. False where too little of it is seen or the pixel
  /// is outside the surfaces' region. Cost: four lookups (summed-area table, Crow 1984).
  bool around(int x, int y, std::uint8_t label, Eigen::Array3f& mean) const;

 private:
  /// Sums of blue, green and red, and their count.
  using Sum = Eigen::Array<std::uint32_t, 4, 1>;
  /// A plane's sums, of all cells above and to the left.
  struct Table {
    bool is_used;  ///< whether the plane is seen in this frame; if not, nothing else is valid
    Image<Sum> sums;
  };
  void find_objects(const Mask& occlusion);
  void add_row(int row, const Image<std::uint8_t>& labels, const Image<Bgr>& picture);
  void add_cells(int row, int first, int last, const Image<std::uint8_t>& labels,
                 const Image<Bgr>& picture);

  Rect region_;
  int columns_ = 0, rows_ = 0;
  std::array<Table, planes> tables_;
  Mask has_object_, near_column_, near_object_;
};

}  // namespace diminish
