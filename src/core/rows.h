#pragma once

#include <oneapi/tbb/parallel_for.h>

namespace diminish {

/// Rows [first, last) of an image that threads share.
struct Rows {
  int first, last;
};

/// Where rows are divided between two threads; 0: too few rows. A multiple of 32, and the same on
/// every machine, so that sums over rows are the same too.
inline int seam(int rows) {
  constexpr int fewest = 128;
  constexpr int unit = 32;
  return rows < fewest ? 0 : (rows / 2 + unit - 1) / unit * unit;
}

/// Calls visit(rows), in two threads if there are many rows. Returns the sum of the results.
template <class Visit>
auto sum_over_rows(int rows, const Visit& visit) {
  const int middle = seam(rows);
  if (middle == 0) return visit(Rows{0, rows});
  decltype(visit(Rows{})) sums[2];
  oneapi::tbb::parallel_for(0, 2, [&](int part) {
    sums[part] = visit(part == 0 ? Rows{0, middle} : Rows{middle, rows});
  });
  return sums[0] + sums[1];
}

/// The same, without a result.
template <class Visit>
void for_rows(int rows, const Visit& visit) {
  sum_over_rows(rows, [&](Rows part) {
    visit(part);
    return 0;
  });
}

}  // namespace diminish
