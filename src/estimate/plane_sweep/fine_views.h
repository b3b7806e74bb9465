#pragma once

#include <cstdint>

#include "diminish/image.h"
#include "estimate/plane_sweep/sweep_geometry.h"

namespace diminish {

/// Two views at twice the resolution of those that were matched.
struct FineViews {
  const Image<std::uint8_t>& reference;
  const Image<std::uint32_t>& reference_census;
  const Image<std::uint8_t>& other;
  const Image<std::uint32_t>& other_census;
  Parallax parallax;
};

/// Calls add(row, sign) for the rows by which a window of 2 * reach + 1 rows changes as its middle
/// goes to row y; for all of its rows if it begins there.
template <class Add>
void move_window(int y, bool begins, int reach, int height, const Add& add) {
  const int last = y + reach;
  if (begins) {
    for (int row = y > reach ? y - reach : 0; row < last && row < height; ++row) add(row, 1);
  } else if (y - reach - 1 >= 0) {
    add(y - reach - 1, -1);
  }
  if (last < height) add(last, 1);
}

/// Sums over 2 * reach + 1 columns. columns: with `reach` zeros more on both sides, from the first
/// of these on.
template <int reach, class Number>
void add_columns(const Number* columns, int count, Number* sums) {
  for (int x = 0; x < count; ++x) {
    Number sum = 0;
    for (int i = 0; i <= 2 * reach; ++i) sum = static_cast<Number>(sum + columns[x + i]);
    sums[x] = sum;
  }
}

}  // namespace diminish
