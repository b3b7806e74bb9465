#include "geometry/rigid_least_squares.h"

#include <Eigen/Cholesky>

namespace diminish {

template <class Scalar>
auto NormalEquations<Scalar>::solve(Scalar damping) const -> Vector {
  Matrix damped = squares;
  damped.diagonal() *= 1 + damping;
  return damped.ldlt().solve(products);
}

template struct NormalEquations<float>;
template struct NormalEquations<double>;

}  // namespace diminish
