#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/rows.h"
#include "core/tasks.h"
#include "depth/visible_blocks.h"
#include "diminish/depth_estimator.h"
#include "estimate/plane_sweep/plane_sweep.h"

namespace diminish {
namespace {

/// Cameras nearer to each other than this see no parallax.
constexpr double least_baseline_m = 0.01;

/// Depth from two or more colour pictures: each camera's is swept against the picture of the camera
/// that looks most alike, and kept where a depth image of another camera agrees.
class StereoEstimator final : public DepthEstimator {
 public:
  explicit StereoEstimator(const Rig& rig) {
    for (const RgbdCamera& camera : rig.rgbd) {
      const int shrinkage = std::max(1, camera.color.width / usual_columns);
      cameras_.push_back({.rig = camera,
                          .picture = GreyPicture(camera.color, shrinkage),
                          .visible = VisibleBlocks(camera, rig.color),
                          .sweep = PlaneSweep(camera.depth)});
    }
    if (cameras_.size() < 2) {
      throw Error(Error::input,
                  "estimate_depth: stereo needs two cameras beside the user's, the rig has " +
                      std::to_string(cameras_.size()));
    }
  }

  void estimate(const Inputs& inputs, std::vector<Image<std::uint16_t>>& depths,
                std::vector<std::string>& messages) override {
    for_tasks(cameras_.size(), [&](std::size_t k) { begin(inputs, k); });
    for (std::size_t k = 0; k < cameras_.size(); ++k) {
      Camera& camera = cameras_[k];
      camera.partner.reset();
      if (!inputs.wanted[k]) continue;
      camera.partner = find_partner(k);
      if (!camera.partner) {
        messages.push_back(camera.rig.name +
                           ": no other camera sees the scene from elsewhere, so its depth is not "
                           "known");
      }
    }
    for_tasks(cameras_.size(), [&](std::size_t k) {
      if (cameras_[k].partner) sweep(inputs, k);
    });
    for_tasks(cameras_.size(), [&](std::size_t k) {
      if (cameras_[k].partner) write(k, depths[k]);
    });
  }

 private:
  static constexpr int usual_columns = 960;

  struct Camera {
    RgbdCamera rig;
    GreyPicture picture;
    VisibleBlocks visible;
    PlaneSweep sweep;
    std::optional<RigidTransform> user_from_color = {};  ///< unknown: it has no picture, or no pose
    std::optional<std::size_t> partner = {};
    Image<float> inverse_depth = {};
  };

  void begin(const Inputs& inputs, std::size_t k) {
    Camera& camera = cameras_[k];
    const RgbdFrame& rgbd = inputs.frame.rgbd[k];
    const auto& user_from_depth = inputs.poses.color_from_depth[k];
    camera.user_from_color.reset();
    if (!user_from_depth || !rgbd.has_picture()) return;
    camera.user_from_color = *user_from_depth * camera.rig.color_from_depth.inverse();
    camera.picture.take(rgbd.color, inputs.masks.rgbd_color[k]);
  }

  RigidTransform other_from(std::size_t k, std::size_t other) const {
    return cameras_[other].user_from_color->inverse() * *cameras_[k].user_from_color;
  }

  /// The camera that looks in the most similar direction.
  std::optional<std::size_t> find_partner(std::size_t k) const {
    std::optional<std::size_t> best;
    double best_cosine = 0;
    for (std::size_t other = 0; other < cameras_.size(); ++other) {
      if (other == k || !cameras_[other].user_from_color) continue;
      const RigidTransform other_from_own = other_from(k, other);
      if (other_from_own.translation.norm() < least_baseline_m) continue;
      const double cosine = other_from_own.rotation(2, 2);
      if (cosine > best_cosine) {
        best = other;
        best_cosine = cosine;
      }
    }
    return best;
  }

  void sweep(const Inputs& inputs, std::size_t k) {
    Camera& camera = cameras_[k];
    camera.visible.find(static_cast<float>(camera.rig.nearest_m),
                        static_cast<float>(camera.rig.farthest_m), *camera.user_from_color,
                        inputs.drawn);
    camera.sweep.sweep(camera.picture, cameras_[*camera.partner].picture,
                       other_from(k, *camera.partner),
                       {camera.rig.nearest_m, camera.rig.farthest_m},
                       camera.visible.part().bounds(), camera.inverse_depth);
  }

  /// Writes what another camera's depth agrees with.
  void write(std::size_t k, Image<std::uint16_t>& depth) const {
    const Camera& camera = cameras_[k];
    const Intrinsics& view = camera.rig.depth;
    const Rect part = intersect(camera.sweep.swept(), view.bounds());
    for_rows(part.height, [&](Rows rows) {
      for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
        for (int x = part.x; x < part.right(); ++x) {
          const float inverse_depth = camera.inverse_depth(x, y);
          if (!(inverse_depth > 0)) continue;
          const double z = 1 / static_cast<double>(inverse_depth);
          const Eigen::Vector3d point((x - view.cx) / view.fx * z, (y - view.cy) / view.fy * z, z);
          if (!is_confirmed(k, point)) continue;
          const double value = std::round(z / camera.rig.depth_unit_m);
          if (value < 65536) depth(x, y) = static_cast<std::uint16_t>(value);
        }
      }
    });
  }

  /// Whether a camera that measures depth, or whose own sweep ended there, sees the point.
  bool is_confirmed(std::size_t k, const Eigen::Vector3d& point) const {
    const std::size_t other = *cameras_[k].partner;
    const Camera& witness = cameras_[other];
    // Without a depth image of its own it cannot object.
    if (!witness.partner) return true;
    const Eigen::Vector3d seen = other_from(k, other) * point;
    if (!(seen.z() > 0)) return false;
    const Intrinsics& view = witness.rig.depth;
    const auto x = static_cast<int>(std::lround(view.fx * seen.x() / seen.z() + view.cx));
    const auto y = static_cast<int>(std::lround(view.fy * seen.y() / seen.z() + view.cy));
    if (!witness.sweep.swept().contains(x, y) || !view.bounds().contains(x, y)) return false;
    const float found = witness.inverse_depth(x, y);
    constexpr float tolerance_px = 3;
    return found > 0 && std::abs(found - static_cast<float>(1 / seen.z())) <
                            tolerance_px * witness.sweep.step_of_pixel();
  }

  std::vector<Camera> cameras_;
};

const bool registered = Registry<DepthEstimator>::add(
    "stereo", [](const Rig& rig, const Scene&) { return std::make_unique<StereoEstimator>(rig); });

}  // namespace
}  // namespace diminish
