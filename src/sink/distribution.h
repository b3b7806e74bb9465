#pragma once

#include <vector>

namespace diminish {

/// What a number of measurements amount to. Percentiles are nearest ranks: the smallest value that
/// at least that share of all values does not exceed.
struct Distribution {
  double average = 0, least = 0, most = 0;
  double p50 = 0, p95 = 0, p99 = 0;
};

/// All 0 without values.
Distribution distribution_of(std::vector<double> values);

}  // namespace diminish
