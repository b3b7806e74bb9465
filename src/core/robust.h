#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace diminish {

/// The median (the upper one of two). Reorders `values`, which must not be empty.
template <class Value>
Value median(std::vector<Value>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The weight of a residual in robust least squares (Beaton & Tukey 1974): 0 from `end` on.
inline float tukey_weight(float residual, float end) {
  const float relative = std::min(1.F, residual / end);
  return (1 - relative * relative) * (1 - relative * relative);
}

}  // namespace diminish
