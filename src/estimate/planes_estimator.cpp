#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "core/tasks.h"
#include "diminish/depth_estimator.h"
#include "estimate/feature_planes.h"
#include "estimate/plane_depth.h"
#include "pose/known_markers.h"
#include "pose/marker_pose.h"

namespace diminish {
namespace {

/// Depth from planes that the scene names: what a homography shows (Zokai et al. 2003), by the
/// stages that draw any depth image.
class PlanesEstimator final : public DepthEstimator {
 public:
  PlanesEstimator(const Rig& rig, const Scene& scene)
      : rig_(rig), planes_(scene.planes), user_lens_(rig.color) {
    if (planes_.empty()) {
      throw Error(Error::input, "estimate_depth planes: expected planes in scene.yaml");
    }
    for (const RgbdCamera& camera : rig.rgbd) lenses_.emplace_back(camera.color);
  }

  void estimate(const Inputs& inputs, std::vector<Image<std::uint16_t>>& depths,
                std::vector<std::string>& messages) override {
    std::vector<InversePlane> in_user;
    std::vector<Sight> sights;
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      const GivenPlane& plane = planes_[i];
      if (plane.from == GivenPlane::From::features) continue;
      std::string problem;
      const auto found = plane.from == GivenPlane::From::world
                             ? world_plane(plane, inputs, problem)
                             : marker_plane(plane, inputs, problem);
      if (found) {
        in_user.push_back(*found);
        sights.push_back({i, false});
      } else {
        messages.push_back(problem);
      }
    }
    for (std::size_t k = 0; k < depths.size(); ++k) {
      if (!inputs.wanted[k]) continue;
      std::vector<InversePlane> planes;
      planes.reserve(in_user.size());
      const RigidTransform& user_from_depth = *inputs.poses.color_from_depth[k];
      const RgbdCamera& camera = rig_.rgbd[k];
      for (std::size_t i = 0; i < in_user.size(); ++i) {
        planes.push_back(transformed(in_user[i], user_from_depth));
        Sight& sight = sights[i];
        sight.is_in_any =
            sight.is_in_any || is_in_view(planes.back(), camera.depth, camera.depth_unit_m);
      }
      add_feature_planes(inputs, k, planes, messages);
      draw_planes(planes, camera.depth, camera.depth_unit_m, depths[k]);
    }
    for (const Sight& sight : sights) {
      if (sight.is_in_any) continue;
      messages.push_back(fmt::format(
          "planes[{}]: no camera that is used sees it: it is behind them or out of their pictures",
          sight.index));
    }
  }

 private:
  /// Whether any camera sees a plane of the scene.
  struct Sight {
    std::size_t index;
    bool is_in_any;
  };

  static std::optional<InversePlane> world_plane(const GivenPlane& plane, const Inputs& inputs,
                                                 std::string& problem) {
    if (!inputs.poses.color_from_world) {
      problem = "planes: where the world is, is not known";
      return std::nullopt;
    }
    const RigidTransform& user_from_world = *inputs.poses.color_from_world;
    InversePlane in_user = InversePlane::through(user_from_world * plane.point,
                                                 user_from_world.rotation * plane.normal);
    for (const Eigen::Vector3d& corner : plane.corners) {
      in_user.corners.push_back(user_from_world * corner);
    }
    return in_user;
  }

  /// From the first picture that shows the marker.
  std::optional<InversePlane> marker_plane(const GivenPlane& plane, const Inputs& inputs,
                                           std::string& problem) const {
    const auto plane_of = [&](const RigidTransform& user_from_marker) {
      return InversePlane::through(user_from_marker.translation, user_from_marker.rotation.col(2));
    };
    const auto pose_in = [&](const std::vector<Marker>& markers, const Lens& lens) {
      const Marker* const marker = find_marker(markers, plane.marker.id);
      return marker == nullptr ? std::nullopt
                               : estimate_marker_pose(marker->corners, plane.marker.size_m, lens);
    };
    if (const auto pose = pose_in(inputs.markers.color, user_lens_)) {
      return plane_of(pose->camera_from_marker);
    }
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      const auto pose = pose_in(inputs.markers.rgbd[k], lenses_[k]);
      if (!pose || !inputs.poses.color_from_depth[k]) continue;
      return plane_of(*inputs.poses.color_from_depth[k] * rig_.rgbd[k].color_from_depth.inverse() *
                      pose->camera_from_marker);
    }
    problem = fmt::format("planes: marker {} is in no picture", plane.marker.id);
    return std::nullopt;
  }

  void add_feature_planes(const Inputs& inputs, std::size_t k, std::vector<InversePlane>& planes,
                          std::vector<std::string>& messages) const {
    for (const GivenPlane& plane : planes_) {
      if (plane.from != GivenPlane::From::features) continue;
      const std::vector<InversePlane> found =
          find_feature_planes({inputs.frame.rgbd[k].color, inputs.masks.rgbd_color[k], lenses_[k]},
                              {inputs.frame.color, inputs.masks.color, user_lens_},
                              *inputs.poses.color_from_depth[k], plane.count);
      planes.insert(planes.end(), found.begin(), found.end());
      if (found.empty()) {
        messages.push_back(rig_.rgbd[k].name +
                           ": no plane in what it and the user's camera see (planes: features)");
      }
    }
  }

  Rig rig_;
  std::vector<GivenPlane> planes_;
  Lens user_lens_;
  std::vector<Lens> lenses_;
};

const bool registered =
    Registry<DepthEstimator>::add("planes", [](const Rig& rig, const Scene& scene) {
      return std::make_unique<PlanesEstimator>(rig, scene);
    });

}  // namespace
}  // namespace diminish
