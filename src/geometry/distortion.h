#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "diminish/intrinsics.h"

namespace diminish {
namespace distortion {

/// Of z, z^2, ... in atan(s) / s with z = s^2, up to 22.5 degrees; the first term is 1.
/// (Interpolation at Chebyshev's nodes.)
inline constexpr std::array<float, 4> angle_terms = {-0.33332786F, 0.19974082F, -0.13848490F,
                                                     0.079762918F};

}  // namespace distortion

/// Distortion of plain numbers: distort_ray and angle_over_radius of distortion_formulas.h.
namespace plain {

template <class Number>
Number square_root(const Number& value) {
  using std::sqrt;
  return sqrt(value);
}

#define DIMINISH_FORMULA
#include "geometry/distortion_formulas.h"
#undef DIMINISH_FORMULA

}  // namespace plain

/// Calls visit with the model as a std::integral_constant, which templates can be chosen by.
template <class Visit>
decltype(auto) with_lens_model(LensModel model, const Visit& visit) {
  switch (model) {
    case LensModel::rational:
      return visit(std::integral_constant<LensModel, LensModel::rational>());
    case LensModel::fisheye:
      return visit(std::integral_constant<LensModel, LensModel::fisheye>());
    case LensModel::plumb_bob:
      break;
  }
  return visit(std::integral_constant<LensModel, LensModel::plumb_bob>());
}

}  // namespace diminish
