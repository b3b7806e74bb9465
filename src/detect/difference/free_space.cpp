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

}  // namespace

FreeSpace::FreeSpace(const Rig& rig) {
  for (const RgbdCamera& camera : rig.rgbd) {
    Camera& added = cameras_.emplace_back();
    added.projection = Projection(Lens(camera.depth));
    added.unit_m = static_cast<float>(camera.depth_unit_m);
  }
}

void FreeSpace::begin(const FrameSet& frame, const Poses& poses) {
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    Camera& camera = cameras_[k];
    camera.depth = {};
    if (!frame.rgbd[k].available() || !poses.color_from_depth[k]) continue;
    camera.depth = frame.rgbd[k].depth;
    camera.depth_from_color = FloatTransform(poses.color_from_depth[k]->inverse());
  }
}

bool FreeSpace::is_free(const Eigen::Vector2f& ray, float from_m, float to_m) const {
  const float end_m = (1 - far_end) * to_m;
  for (int i = 0; i < points; ++i) {
    const float depth_m = from_m + (end_m - from_m) * static_cast<float>(i) / (points - 1);
    const Eigen::Vector3f point = depth_m * ray.homogeneous();
    if (std::none_of(cameras_.begin(), cameras_.end(),
                     [&](const Camera& camera) { return is_free(camera, point); })) {
      return false;
    }
  }
  return true;
}

bool FreeSpace::is_free(const Camera& camera, const Eigen::Vector3f& point_m) const {
  if (camera.depth.empty()) return false;
  const Eigen::Vector3f point = transform(camera.depth_from_color, point_m);
  const auto pixel = project(camera.projection, point);
  if (!pixel || !camera.depth.bounds().contains(pixel->x, pixel->y)) return false;
  const float measured_m = static_cast<float>(camera.depth(pixel->x, pixel->y)) * camera.unit_m;
  return measured_m > (1 + uncertainty) * point.z();
}

}  // namespace diminish
