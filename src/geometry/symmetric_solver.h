#pragma once

#include <Eigen/Core>

namespace diminish {

/// Solves squares * x = products for a positive semidefinite matrix, as least squares have, by
/// Eigen's LDLT. Compiled once, for two to six floats and for six doubles.
template <class Scalar, int size>
Eigen::Matrix<Scalar, size, 1> solve_symmetric(const Eigen::Matrix<Scalar, size, size>& squares,
                                               const Eigen::Matrix<Scalar, size, 1>& products);

}  // namespace diminish
