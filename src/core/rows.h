#pragma once

#include <algorithm>
#include <array>

#include "core/tasks.h"

namespace diminish {

/// Rows [first, last) of an image that threads share: one of its bands or groups.
struct Rows {
  int first, last;
  int band = 0;  ///< its number, from 0 on: threads that work on different bands share no memory
};

/// Of one image.
inline constexpr int most_bands = 8;
/// Rows; fewer are not worth a task.
inline constexpr int least_band = 64;

/// Bands are the same on every machine, so that sums over them are the same, too, and small enough
/// that a core that is away delays a frame by one of them. All but the last are this high: a
/// multiple of 32, at least `least`. An image of few rows is one band.
inline int band_height(int rows, int least = least_band) {
  constexpr int unit = 32;
  if (rows < 2 * least) return std::max(rows, 1);
  const int even = (rows + most_bands - 1) / most_bands;
  return std::max(least, (even + unit - 1) / unit * unit);
}

/// Calls visit(rows) for each band; whichever thread is free takes the next. Returns the sum of the
/// results, added up in the bands' order.
template <class Visit>
auto sum_over_rows(int rows, const Visit& visit, int least = least_band) {
  const int height = band_height(rows, least);
  const int bands = (rows + height - 1) / height;
  if (bands <= 1) return visit(Rows{0, rows});
  std::array<decltype(visit(Rows{})), most_bands> sums;
  for_tasks(static_cast<std::size_t>(bands), [&](std::size_t i) {
    const auto band = static_cast<int>(i);
    sums[i] = visit(Rows{band * height, std::min((band + 1) * height, rows), band});
  });
  auto sum = sums[0];
  for (int band = 1; band < bands; ++band) sum = sum + sums[static_cast<std::size_t>(band)];
  return sum;
}

/// The same, without a result.
template <class Visit>
void for_rows(int rows, const Visit& visit, int least = least_band) {
  sum_over_rows(
      rows,
      [&](Rows part) {
        visit(part);
        return 0;
      },
      least);
}

/// Calls visit(rows) for groups of `height` rows: of what has few rows that take long.
template <class Visit>
void for_row_groups(int rows, int height, const Visit& visit) {
  for_tasks(static_cast<std::size_t>((rows + height - 1) / height), [&](std::size_t i) {
    const auto group = static_cast<int>(i);
    visit(Rows{group * height, std::min((group + 1) * height, rows), group});
  });
}

}  // namespace diminish
