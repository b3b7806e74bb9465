#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "detect/color_blob/color_model.h"
#include "diminish/image.h"

namespace diminish {

/// A colour model's deviations in a table of 32^3 colours, with the least of each one's
/// neighbourhood: a quick test of which pixels may belong to the object at all.
class ColorTable {
 public:
  explicit ColorTable(const ColorModel& model);

  /// A colour's deviation with tint and value weighted alike, and with half the value's, which
  /// shading changes most. In 1 / per_deviation standard deviations.
  struct Entry {
    std::uint8_t core, neighbor;
  };
  static constexpr int per_deviation = 8;

  const Entry& operator()(const Bgr& color) const {
    return entries_[entry(color.b / step, color.g / step, color.r / step)];
  }

 private:
  static constexpr int side = 32;
  static constexpr int step = 256 / side;
  static std::size_t entry(std::size_t b, std::size_t g, std::size_t r) {
    return (b * side + g) * side + r;
  }
  std::vector<Entry> entries_;
};

}  // namespace diminish
