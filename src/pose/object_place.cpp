#include "pose/object_place.h"

#include <cmath>
#include <numeric>

#include "diminish/occluder_settings.h"
#include "geometry/triangle_mesh.h"
#include "pose/depth_check.h"
#include "pose/known_markers.h"
#include "pose/marker_pose.h"

namespace diminish {
namespace {

/// What poses and depth leave open.
constexpr double tolerance_m = 0.02;
constexpr double relative_tolerance = 0.02;
/// Of an object's points: else too little of it is in view.
constexpr double fewest_share = 0.5;
constexpr std::size_t fewest_points = 6;

/// Points within the hull, as far from its middle as from its rim.
std::vector<Eigen::Vector3d> points_within(const std::vector<Eigen::Vector3d>& vertices) {
  if (vertices.empty()) return {};
  const Eigen::Vector3d middle =
      std::accumulate(vertices.begin(), vertices.end(), Eigen::Vector3d(0, 0, 0)) /
      static_cast<double>(vertices.size());
  std::vector<Eigen::Vector3d> points = {middle};
  constexpr std::size_t most_vertices = 12;
  const std::size_t step = (vertices.size() + most_vertices - 1) / most_vertices;
  for (std::size_t i = 0; i < vertices.size(); i += step) {
    for (std::size_t j = 0; j <= i; j += step) {
      points.emplace_back(middle / 2 + (vertices[i] + vertices[j]) / 4);
    }
  }
  return points;
}

std::vector<Eigen::Vector3d> points_on(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> points;
  constexpr std::size_t most_points = 100;
  const std::size_t step = (mesh.triangles.size() + most_points - 1) / most_points;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += step) {
    Eigen::Vector3d sum(0, 0, 0);
    for (const int vertex : mesh.triangles[i])
      sum += mesh.vertices[static_cast<std::size_t>(vertex)];
    points.emplace_back(sum / 3);
  }
  return points;
}

std::vector<Eigen::Vector3d> points_of(const MarkerSettings& settings) {
  if (!settings.mesh.empty()) return points_on(load_obj(settings.mesh));
  if (!settings.triangles.empty()) return points_on({settings.vertices, settings.triangles});
  return points_within(settings.vertices);
}

}  // namespace

ObjectPlace::ObjectPlace(const Rig& rig, const Scene& scene) : rig_(rig), color_lens_(rig.color) {
  for (const RgbdCamera& camera : rig.rgbd) depth_lenses_.emplace_back(camera.depth);
  for (const OccluderSpec& occluder : scene.occluders) {
    const auto* const settings = dynamic_cast<const MarkerSettings*>(occluder.settings.get());
    if (settings) objects_.push_back({settings->marker, points_of(*settings)});
  }
}

std::optional<double> ObjectPlace::behind_m(const Eigen::Vector3d& point_in_color_m,
                                            const View& view) const {
  const auto at = depth_at(view.depth_from_color * point_in_color_m, depth_lenses_[view.camera],
                           view.depth, rig_.rgbd[view.camera].depth_unit_m);
  if (!at) return std::nullopt;
  return at->measured_m - at->computed_m;
}

bool ObjectPlace::is_covered(const Eigen::Vector3d& point_in_color_m, const View& view) const {
  constexpr double step = 0.01;
  constexpr int first = 4;  // what is so near belongs to it
  constexpr int last = 25;
  for (int i = first; i < last; ++i) {
    const auto behind = behind_m((1 - i * step) * point_in_color_m, view);
    if (behind && std::abs(*behind) < step * point_in_color_m.z()) return true;
  }
  return false;
}

std::optional<PlaceOfObject> ObjectPlace::examine(const Object& object,
                                                  const RigidTransform& color_from_marker,
                                                  const View& view) const {
  std::size_t looked_at = 0;
  std::size_t seen_through = 0;
  for (const Eigen::Vector3d& point_m : object.points_m) {
    const Eigen::Vector3d at_m = color_from_marker * point_m;
    const auto behind = behind_m(at_m, view);
    if (!behind) continue;
    ++looked_at;
    if (*behind > tolerance_m + relative_tolerance * at_m.z()) ++seen_through;
  }
  const auto points = static_cast<double>(object.points_m.size());
  if (looked_at < fewest_points || static_cast<double>(looked_at) < fewest_share * points) {
    return std::nullopt;
  }
  constexpr int side = 4;
  int covered = 0;
  for (int i = 0; i < side * side; ++i) {
    const int row = i / side;
    const double x = (i % side + 0.5) / side - 0.5;
    const double y = (row + 0.5) / side - 0.5;
    const Eigen::Vector3d on_marker_m = object.marker.size_m * Eigen::Vector3d(x, y, 0);
    covered += is_covered(color_from_marker * on_marker_m, view) ? 1 : 0;
  }
  return PlaceOfObject{object.marker.id,
                       static_cast<double>(seen_through) / static_cast<double>(looked_at),
                       static_cast<double>(covered) / (side * side)};
}

void ObjectPlace::find(const FrameSet& frame, const Markers& markers, const Poses& poses,
                       std::vector<std::optional<PlaceOfObject>>& by_camera) const {
  by_camera.assign(rig_.rgbd.size(), std::nullopt);
  for (const Object& object : objects_) {
    const Marker* const seen = find_marker(markers.color, object.marker.id);
    if (!seen) continue;
    const auto pose = estimate_marker_pose(seen->corners, object.marker.size_m, color_lens_);
    if (!pose) continue;
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      if (!rig_.rgbd[k].measures_depth || frame.rgbd[k].depth.empty() ||
          !poses.color_from_depth[k] || (by_camera[k] && by_camera[k]->is_wrong())) {
        continue;
      }
      const View view{k, poses.color_from_depth[k]->inverse(), frame.rgbd[k].depth};
      auto found = examine(object, pose->camera_from_marker, view);
      if (found && found->is_wrong() && pose->is_doubtful()) {
        found = examine(object, pose->alternative, view);
      }
      if (found) by_camera[k] = found;
    }
  }
}

}  // namespace diminish
