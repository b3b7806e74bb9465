#pragma once

namespace diminish {

/// Bilinear interpolation of at(column, row) at x, y >= 0: asks for the pixel at their whole parts
/// and for those to its right and below.
template <class At>
auto bilinear(float x, float y, const At& at) -> decltype(at(0, 0)) {
  using Value = decltype(at(0, 0));
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const auto between = [](const Value& from, const Value& to, float share) -> Value {
    return from + share * (to - from);
  };
  const float right = x - static_cast<float>(column);
  const Value top = between(at(column, row), at(column + 1, row), right);
  const Value bottom = between(at(column, row + 1), at(column + 1, row + 1), right);
  return between(top, bottom, y - static_cast<float>(row));
}

}  // namespace diminish
