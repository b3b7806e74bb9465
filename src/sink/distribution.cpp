#include "sink/distribution.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace diminish {

Distribution distribution_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto count = static_cast<double>(values.size());
  const auto percentile = [&](int percent) {
    // Integers, so that an exact rank is not rounded up.
    const std::size_t rank = (values.size() * static_cast<std::size_t>(percent) + 99) / 100;
    return values[rank - 1];
  };
  return {std::accumulate(values.begin(), values.end(), 0.0) / count,
          values.front(),
          values.back(),
          percentile(50),
          percentile(95),
          percentile(99)};
}

}  // namespace diminish
