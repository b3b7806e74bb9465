#include "detect/difference/free_space.h"

#include <algorithm>

namespace diminish {
namespace {

/// Points on a line of sight that are tried.
constexpr int points = 8;
/// Nearer to what is measured than this share of its distance, a point may lie on it.
constexpr float uncertainty = 0.03F;
/// This share of the distance at the far end belongs to what is there.
constexpr float far_end = 0.08F;

/// Whether a point is well in front of what the camera measures.
bool is_before(const DepthView& camera, const Eigen::Vector3f& point_m) {
  const auto depth = camera.at(point_m);
  return depth && depth->measured_m > (1 + uncertainty) * depth->own_m;
}

}  // namespace

FreeSpace::FreeSpace(const Rig& rig) {
  for (const RgbdCamera& camera : rig.rgbd) cameras_.emplace_back(camera);
}

void FreeSpace::begin(const FrameSet& frame, const Poses& poses) {
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    cameras_[k].clear();
    if (!frame.rgbd[k].available() || !poses.color_from_depth[k]) continue;
    cameras_[k].begin(frame.rgbd[k].depth, {}, poses.color_from_depth[k]->inverse());
  }
}

bool FreeSpace::is_free(const Eigen::Vector2f& ray, float from_m, float to_m) const {
  const float end_m = (1 - far_end) * to_m;
  for (int i = 0; i < points; ++i) {
    const float depth_m = from_m + (end_m - from_m) * static_cast<float>(i) / (points - 1);
    const Eigen::Vector3f point = depth_m * ray.homogeneous();
    if (std::none_of(cameras_.begin(), cameras_.end(),
                     [&](const DepthView& camera) { return is_before(camera, point); })) {
      return false;
    }
  }
  return true;
}

}  // namespace diminish
