#include "source/read_rigid_transform.h"

#include "geometry/rotation.h"
#include "source/configuration_checks.h"

namespace diminish {

RigidTransform read_rigid_transform(const Config& config) {
  config.expect_keys({"rotation", "translation"});
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const std::vector<double> numbers = config.at("rotation").numbers(9);
  const RigidTransform given{Eigen::Map<const RowMajor>(numbers.data()),
                             config.at("translation").vector3()};
  check_rigid_transform(given, config);
  return {nearest_rotation(given.rotation), given.translation};
}

}  // namespace diminish
