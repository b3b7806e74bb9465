#include "geometry/symmetric_solver.h"

#include <Eigen/Cholesky>

namespace diminish {

template <class Scalar, int size>
Eigen::Matrix<Scalar, size, 1> solve_symmetric(const Eigen::Matrix<Scalar, size, size>& squares,
                                               const Eigen::Matrix<Scalar, size, 1>& products) {
  return squares.ldlt().solve(products);
}

template Eigen::Matrix<float, 2, 1> solve_symmetric(const Eigen::Matrix<float, 2, 2>&,
                                                    const Eigen::Matrix<float, 2, 1>&);
template Eigen::Matrix<float, 3, 1> solve_symmetric(const Eigen::Matrix<float, 3, 3>&,
                                                    const Eigen::Matrix<float, 3, 1>&);
template Eigen::Matrix<float, 4, 1> solve_symmetric(const Eigen::Matrix<float, 4, 4>&,
                                                    const Eigen::Matrix<float, 4, 1>&);
template Eigen::Matrix<float, 5, 1> solve_symmetric(const Eigen::Matrix<float, 5, 5>&,
                                                    const Eigen::Matrix<float, 5, 1>&);
template Eigen::Matrix<float, 6, 1> solve_symmetric(const Eigen::Matrix<float, 6, 6>&,
                                                    const Eigen::Matrix<float, 6, 1>&);
template Eigen::Matrix<double, 6, 1> solve_symmetric(const Eigen::Matrix<double, 6, 6>&,
                                                     const Eigen::Matrix<double, 6, 1>&);

}  // namespace diminish
