#include "estimate/given_planes.h"

#include <fmt/format.h>

#include "pose/known_markers.h"
#include "pose/marker_pose.h"

namespace diminish {

GivenPlanes::GivenPlanes(const Rig& rig, const Scene& scene)
    : planes_(scene.planes), user_lens_(rig.color) {
  for (const RgbdCamera& camera : rig.rgbd) {
    lenses_.emplace_back(camera.color);
    depth_from_color_.push_back(camera.color_from_depth.inverse());
  }
}

void GivenPlanes::find(const Markers& markers, const Poses& poses, std::vector<Found>& found,
                       std::vector<std::string>& messages) const {
  found.clear();
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const GivenPlane& plane = planes_[i];
    if (plane.from == GivenPlane::From::features) continue;
    std::string problem;
    const auto in_user = plane.from == GivenPlane::From::world
                             ? by_world(plane, poses, problem)
                             : by_marker(plane, markers, poses, problem);
    if (in_user) {
      found.push_back({i, *in_user});
    } else {
      messages.push_back(problem);
    }
  }
}

std::optional<InversePlane> GivenPlanes::by_world(const GivenPlane& plane, const Poses& poses,
                                                  std::string& problem) {
  if (!poses.color_from_world) {
    problem = "planes: where the world is, is not known";
    return std::nullopt;
  }
  const RigidTransform& user_from_world = *poses.color_from_world;
  InversePlane in_user =
      InversePlane::through(user_from_world * plane.point, user_from_world.rotation * plane.normal);
  for (const Eigen::Vector3d& corner : plane.corners) {
    in_user.corners.push_back(user_from_world * corner);
  }
  return in_user;
}

/// From the first picture that shows the marker.
std::optional<InversePlane> GivenPlanes::by_marker(const GivenPlane& plane, const Markers& markers,
                                                   const Poses& poses, std::string& problem) const {
  const auto plane_of = [&](const RigidTransform& user_from_marker) {
    return InversePlane::through(user_from_marker.translation, user_from_marker.rotation.col(2));
  };
  const auto pose_in = [&](const std::vector<Marker>& seen, const Lens& lens) {
    const Marker* const marker = find_marker(seen, plane.marker.id);
    return marker == nullptr ? std::nullopt
                             : estimate_marker_pose(marker->corners, plane.marker.size_m, lens);
  };
  if (const auto pose = pose_in(markers.color, user_lens_)) {
    return plane_of(pose->camera_from_marker);
  }
  for (std::size_t k = 0; k < lenses_.size(); ++k) {
    const auto pose = pose_in(markers.rgbd[k], lenses_[k]);
    if (!pose || !poses.color_from_depth[k]) continue;
    return plane_of(*poses.color_from_depth[k] * depth_from_color_[k] * pose->camera_from_marker);
  }
  problem = fmt::format("planes: marker {} is in no picture", plane.marker.id);
  return std::nullopt;
}

}  // namespace diminish
