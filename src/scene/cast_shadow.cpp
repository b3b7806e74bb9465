#include "scene/cast_shadow.h"

#include <Eigen/Geometry>
#include <cmath>

namespace diminish {

CastShadow::Ground::Ground(const BackgroundPlane& plane_, const Eigen::Vector3f& middle)
    : plane(plane_), origin(middle - plane_.height_m(middle) * plane_.normal) {
  const Eigen::Vector3f& normal = plane.normal;
  const Eigen::Vector3f axis =
      std::abs(normal.x()) < 0.7F ? Eigen::Vector3f::UnitX() : Eigen::Vector3f::UnitY();
  along_u = (axis - axis.dot(normal) * normal).normalized();
  along_v = normal.cross(along_u);
}
Eigen::Vector3f CastShadow::Ground::point_m(const Eigen::Vector2f& place) const {
  return origin + place.x() * along_u + place.y() * along_v;
}

float CastShadow::light_at(const Eigen::Vector3f& point_m) const {
  const Rect cell = cell_of(ground.coordinates(point_m));
  return light.bounds().contains(cell.x, cell.y) ? light(cell.x, cell.y).mean() : 1.F;
}

}  // namespace diminish
