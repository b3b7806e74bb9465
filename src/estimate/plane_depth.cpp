#include "estimate/plane_depth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/rows.h"

namespace diminish {
namespace {

/// The columns of a row, in a picture of this width, in which the plane is seen. Each side of its
/// part lies in a plane through the camera, which a row crosses once.
struct Columns {
  int first, last;
};
Columns columns_of(const InversePlane& plane, const Intrinsics& view, int y) {
  double first = 0;
  double last = view.width;
  for (std::size_t i = 0; i < plane.corners.size(); ++i) {
    const Eigen::Vector3d side = plane.inward(i);
    const double at_zero =
        side.x() * (-view.cx / view.fx) + side.y() * ((y - view.cy) / view.fy) + side.z();
    const double step = side.x() / view.fx;
    const double crossing = step != 0 ? -at_zero / step : 0;
    if (step > 0) {
      first = std::max(first, std::ceil(crossing));
    } else if (step < 0) {
      last = std::min(last, std::floor(crossing) + 1);
    } else if (at_zero < 0) {
      last = 0;
    }
  }
  return {static_cast<int>(std::min<double>(first, view.width)),
          static_cast<int>(std::max(0.0, last))};
}

/// Cuts off what lies less than 1 cm in front of the camera (Sutherland & Hodgman 1974).
InversePlane in_front(const InversePlane& plane) {
  constexpr double nearest_m = 0.01;
  InversePlane cut{plane.inverse, {}};
  const std::size_t count = plane.corners.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d& from = plane.corners[i];
    const Eigen::Vector3d& to = plane.corners[(i + 1) % count];
    if (from.z() >= nearest_m) cut.corners.push_back(from);
    if ((from.z() >= nearest_m) == (to.z() >= nearest_m)) continue;
    cut.corners.emplace_back(from + (nearest_m - from.z()) / (to.z() - from.z()) * (to - from));
  }
  return cut;
}

/// Beyond it a depth does not fit into the image.
double least_inverse_depth(double depth_unit_m) {
  constexpr double greatest_value = 65535;
  return 1 / (greatest_value * depth_unit_m);
}

}  // namespace

Eigen::Vector3d InversePlane::inward(std::size_t i) const {
  const std::size_t count = corners.size();
  const Eigen::Vector3d normal = corners[i].cross(corners[(i + 1) % count]);
  // The next corner is inside.
  return normal.dot(corners[(i + 2) % count]) < 0 ? -normal : normal;
}

bool InversePlane::is_met_by(const Eigen::Vector2d& ray) const {
  const Eigen::Vector3d along(ray.x(), ray.y(), 1);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (inward(i).dot(along) < 0) return false;
  }
  return true;
}

double nearest_inverse_depth(std::span<const InversePlane> planes, const Eigen::Vector2d& ray) {
  double nearest = 0;
  for (const InversePlane& plane : planes) {
    const double inverse = plane.inverse_depth(ray);
    if (inverse > nearest && plane.is_met_by(ray)) nearest = inverse;
  }
  return nearest;
}

bool is_in_view(const InversePlane& plane, const Intrinsics& view, double depth_unit_m) {
  const InversePlane cut = in_front(plane);
  if (!plane.corners.empty() && cut.corners.empty()) return false;
  for (int y = 0; y < view.height; ++y) {
    const Columns columns = columns_of(cut, view, y);
    if (columns.first >= columns.last) continue;
    // Along a row the inverse depth is greatest at one of its ends.
    for (const int x : {columns.first, columns.last - 1}) {
      const Eigen::Vector2d ray((x - view.cx) / view.fx, (y - view.cy) / view.fy);
      if (plane.inverse_depth(ray) > least_inverse_depth(depth_unit_m)) return true;
    }
  }
  return false;
}

void draw_planes(const std::vector<InversePlane>& planes, const Intrinsics& view,
                 double depth_unit_m, Image<std::uint16_t>& depth) {
  const auto least = static_cast<float>(least_inverse_depth(depth_unit_m));
  const auto unit = static_cast<float>(depth_unit_m);
  std::vector<InversePlane> visible;
  for (const InversePlane& plane : planes) {
    const InversePlane cut = in_front(plane);
    if (plane.corners.empty() || !cut.corners.empty()) visible.push_back(cut);
  }
  for_rows(view.height, [&](Rows rows) {
    std::vector<float> nearest(static_cast<std::size_t>(view.width));
    for (int y = rows.first; y < rows.last; ++y) {
      std::fill(nearest.begin(), nearest.end(), 0.F);
      for (const InversePlane& plane : visible) {
        // Along a row a plane's inverse depth changes evenly.
        const Eigen::Vector2d ray(-view.cx / view.fx, (y - view.cy) / view.fy);
        const auto first = static_cast<float>(plane.inverse_depth(ray));
        const auto step = static_cast<float>(plane.inverse.x() / view.fx);
        const Columns columns = columns_of(plane, view, y);
        for (int x = columns.first; x < columns.last; ++x) {
          float& known = nearest[static_cast<std::size_t>(x)];
          known = std::max(known, first + static_cast<float>(x) * step);
        }
      }
      std::uint16_t* const row = depth.row(y);
      for (int x = 0; x < view.width; ++x) {
        const float inverse = nearest[static_cast<std::size_t>(x)];
        row[x] =
            inverse > least ? static_cast<std::uint16_t>(std::lround(1 / (inverse * unit))) : 0;
      }
    }
  });
}

}  // namespace diminish
