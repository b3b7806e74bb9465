#include <fmt/format.h>

#include <string>
#include <vector>

#include "core/tasks.h"
#include "diminish/depth_estimator.h"
#include "estimate/feature_planes.h"
#include "estimate/given_planes.h"
#include "estimate/plane_depth.h"

namespace diminish {
namespace {

/// Depth from planes that the scene names: what a homography shows (Zokai et al. 2003), by the
/// stages that draw any depth image.
class PlanesEstimator final : public DepthEstimator {
 public:
  PlanesEstimator(const Rig& rig, const Scene& scene)
      : rig_(rig), given_(rig, scene), planes_(scene.planes), user_lens_(rig.color) {
    if (planes_.empty()) {
      throw Error(Error::input, "estimate_depth planes: expected planes in scene.yaml");
    }
    for (const RgbdCamera& camera : rig.rgbd) lenses_.emplace_back(camera.color);
  }

  void estimate(const Inputs& inputs, std::vector<Image<std::uint16_t>>& depths,
                std::vector<std::string>& messages) override {
    std::vector<GivenPlanes::Found> found;
    given_.find(inputs.markers, inputs.poses, found, messages);
    std::vector<char> is_seen(found.size(), 0);
    for (std::size_t k = 0; k < depths.size(); ++k) {
      if (!inputs.wanted[k]) continue;
      std::vector<InversePlane> planes;
      planes.reserve(found.size());
      const RigidTransform& user_from_depth = *inputs.poses.color_from_depth[k];
      const RgbdCamera& camera = rig_.rgbd[k];
      for (std::size_t i = 0; i < found.size(); ++i) {
        planes.push_back(transformed(found[i].plane, user_from_depth));
        if (is_in_view(planes.back(), camera.depth, camera.depth_unit_m)) is_seen[i] = 1;
      }
      add_feature_planes(inputs, k, planes, messages);
      draw_planes(planes, camera.depth, camera.depth_unit_m, depths[k]);
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (is_seen[i] != 0) continue;
      messages.push_back(fmt::format(
          "planes[{}]: no camera that is used sees it: it is behind them or out of their pictures",
          found[i].index));
    }
  }

 private:
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
  GivenPlanes given_;
  std::vector<GivenPlane> planes_;
  Lens user_lens_;
  std::vector<Lens> lenses_;
};

const bool planes_estimator_registered =
    Registry<DepthEstimator>::add("planes", [](const Rig& rig, const Scene& scene) {
      return std::make_unique<PlanesEstimator>(rig, scene);
    });

}  // namespace
}  // namespace diminish
