#include "detect/marker_views.h"

#include <cmath>

#include "pose/marker_pose.h"

namespace diminish {
namespace {

double area(const std::array<Eigen::Vector2d, 4>& corners) {
  const Eigen::Vector2d a = corners[2] - corners[0];
  const Eigen::Vector2d b = corners[3] - corners[1];
  return std::abs(a.x() * b.y() - a.y() * b.x()) / 2;
}

/// `camera_from_marker`, known in `from`'s camera, in `to`'s camera.
RigidTransform carry_over(const RigidTransform& camera_from_marker, const MarkerView& from,
                          const MarkerView& to) {
  return to.common_from_camera->inverse() * *from.common_from_camera * camera_from_marker;
}

double error_in_all_views(const std::vector<MarkerView>& views, const MarkerView& own,
                          const RigidTransform& camera_from_marker, double size_m) {
  double sum = marker_error_px(camera_from_marker, size_m, *own.lens, *own.corners);
  for (const MarkerView& other : views) {
    if (&other == &own || !other.corners || !other.common_from_camera) continue;
    sum += marker_error_px(carry_over(camera_from_marker, own, other), size_m, *other.lens,
                           *other.corners);
  }
  return sum;
}

std::optional<RigidTransform> own_pose(const std::vector<MarkerView>& views, const MarkerView& view,
                                       double size_m) {
  if (!view.corners) return std::nullopt;
  const auto pose = estimate_marker_pose(*view.corners, size_m, *view.lens);
  if (!pose) return std::nullopt;
  // The other views depend on the cameras' poses, which are not exact either. So they only decide
  // what the view itself cannot.
  constexpr double ambiguous = 0.4;
  if (pose->ambiguity < ambiguous || !view.common_from_camera) return pose->camera_from_marker;
  return error_in_all_views(views, view, pose->alternative, size_m) <
                 error_in_all_views(views, view, pose->camera_from_marker, size_m)
             ? pose->alternative
             : pose->camera_from_marker;
}

}  // namespace

void locate_marker(const std::vector<MarkerView>& views, double size_m,
                   std::vector<std::optional<RigidTransform>>& camera_from_marker) {
  std::vector<std::optional<RigidTransform>>& poses = camera_from_marker;
  poses.assign(views.size(), std::nullopt);
  std::optional<std::size_t> largest;
  for (std::size_t i = 0; i < views.size(); ++i) {
    poses[i] = own_pose(views, views[i], size_m);
    if (!poses[i] || !views[i].common_from_camera) continue;
    if (!largest || area(*views[i].corners) > area(*views[*largest].corners)) largest = i;
  }
  if (!largest) return;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (poses[i] || !views[i].common_from_camera) continue;
    poses[i] = carry_over(*poses[*largest], views[*largest], views[i]);
  }
}

}  // namespace diminish
