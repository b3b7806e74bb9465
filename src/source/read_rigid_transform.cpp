#include "source/read_rigid_transform.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace diminish {
namespace {

constexpr double rotation_tolerance = 1e-3;
/// Metres; larger numbers are most likely millimetres.
constexpr double largest_translation_m = 1000;

Eigen::Matrix3d read_rotation(const Config& config) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const std::vector<double> numbers = config.numbers(9);
  const Eigen::Matrix3d matrix = Eigen::Map<const RowMajor>(numbers.data());
  const Eigen::Matrix3d error = matrix * matrix.transpose() - Eigen::Matrix3d::Identity();
  if (!(error.cwiseAbs().maxCoeff() <= rotation_tolerance)) {
    config.fail("expected a rotation, got a matrix whose rows are not orthonormal");
  }
  if (matrix.determinant() < 0) config.fail("expected a rotation, got a reflection");
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

Eigen::Vector3d read_translation(const Config& config) {
  const Eigen::Vector3d translation = config.vector3();
  if (translation.cwiseAbs().maxCoeff() > largest_translation_m) {
    config.fail("expected metres, got more than a kilometre");
  }
  return translation;
}

}  // namespace

RigidTransform read_rigid_transform(const Config& config) {
  config.expect_keys({"rotation", "translation"});
  return {read_rotation(config.at("rotation")), read_translation(config.at("translation"))};
}

}  // namespace diminish
