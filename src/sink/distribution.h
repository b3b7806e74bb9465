#pragma once

#include <vector>

namespace diminish {

/// Statistics of measurements. Percentiles are nearest ranks: the smallest value that is at least
/// as large as that share of all values.
struct Distribution {
  double average = 0, least = 0, most = 0;
  double p50 = 0, p95 = 0, p99 = 0;
};

/// All 0 if there are no values.
Distribution distribution_of(std::vector<double> values);

}  // namespace diminish
