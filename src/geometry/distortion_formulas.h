// How lenses distort, stated once. Included by distortion.h for plain numbers (float, double,
// Eigen's arrays), and by distortion_vectors-inl.h, once for each instruction set, for Highway's
// vectors; hence no include guard. Both define square_root and DIMINISH_FORMULA. Every operation is
// rounded on its own, in this order, so that all of them compute the same bits.

/// The angle between the axis and a ray (x, y, 1), over the ray's radius: atan(r) / r, to 1e-7;
/// of doubles to their last bits. Two halvings leave the polynomial at most 22.5 degrees.
template <class Real, class Number, class Constant>
DIMINISH_FORMULA Number angle_over_radius(Constant constant, const Number& r2) {
  if constexpr (std::is_same_v<Number, double>) {
    const double r = std::sqrt(r2);
    return r < 1e-4 ? 1 - r2 / 3 : std::atan(r) / r;
  } else {
    constexpr auto& terms = distortion::angle_terms;
    const auto one = constant(Real{1});
    const Number a = one + square_root<Number>(one + r2);
    const Number half_tangent2 = r2 / (a * a);
    const Number b = one + square_root<Number>(one + half_tangent2);
    const Number z = half_tangent2 / (b * b);
    const Number series =
        one + z * (constant(terms[0]) +
                   z * (constant(terms[1]) + z * (constant(terms[2]) + z * constant(terms[3]))));
    return constant(Real{4}) / (a * b) * series;
  }
}

/// Where the lens puts the ray (x, y, 1) on the plane at distance 1. k: the model's coefficients.
/// r2: x * x + y * y. constant: makes a Number, or what calculates with one, of a coefficient.
template <LensModel model, class Real, class Number, class Constant>
DIMINISH_FORMULA void distort_ray(const std::array<Real, 8>& k, Constant constant, const Number& x,
                                  const Number& y, const Number& r2, Number& distorted_x,
                                  Number& distorted_y) {
  const auto one = constant(Real{1});
  if constexpr (model == LensModel::fisheye) {
    const auto per_radius = angle_over_radius<Real>(constant, r2);
    const Number angle2 = per_radius * per_radius * r2;
    const Number series =
        one +
        angle2 * (constant(k[0]) +
                  angle2 * (constant(k[1]) + angle2 * (constant(k[2]) + angle2 * constant(k[3]))));
    const Number factor = per_radius * series;
    distorted_x = x * factor;
    distorted_y = y * factor;
  } else {
    const Number xx = x * x;
    const Number yy = y * y;
    const Number xy = x * y;
    const auto two = constant(Real{2});
    const auto p1 = constant(k[2]);
    const auto p2 = constant(k[3]);
    Number radial = one + r2 * (constant(k[0]) + r2 * (constant(k[1]) + r2 * constant(k[4])));
    if constexpr (model == LensModel::rational) {
      radial = radial /
               Number(one + r2 * (constant(k[5]) + r2 * (constant(k[6]) + r2 * constant(k[7]))));
    }
    distorted_x = x * radial + (constant(Real{2} * k[2]) * xy + p2 * (r2 + two * xx));
    distorted_y = y * radial + (p1 * (r2 + two * yy) + constant(Real{2} * k[3]) * xy);
  }
}
