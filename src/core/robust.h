#pragma once

#include <algorithm>
#include <vector>

namespace diminish {

/// The upper one of two medians; reorders the values, of which there must be one at least.
template <class Iterator>
auto median(Iterator begin, Iterator end) {
  const Iterator middle = begin + (end - begin) / 2;
  std::nth_element(begin, middle, end);
  return *middle;
}
template <class Value>
Value median(std::vector<Value>& values) {
  return median(values.begin(), values.end());
}

/// The weight of a residual in robust least squares (Beaton & Tukey 1974): 0 from `end` on.
inline float tukey_weight(float residual, float end) {
  const float relative = std::min(1.F, residual / end);
  return (1 - relative * relative) * (1 - relative * relative);
}

}  // namespace diminish
