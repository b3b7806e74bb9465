#include "depth/camera_choice.h"

#include <algorithm>
#include <cmath>

#include "core/tasks.h"
#include "diminish/remote_images.h"

namespace diminish {
namespace {

constexpr int tile_px = 8;
/// Places of a tile at which the mask is looked at, along each side.
constexpr int places = 4;
/// Of a depth image, at which it is looked at, along each row.
constexpr int columns_of_image = 256;
/// The most that a remote camera's point stands for, to each side.
constexpr float most_reach_px = 64;
/// Images that are older by this are worth half.
constexpr double half_life_s = 0.1;

/// From the seen point, between where the camera is and where the user is: 1 if they look alike.
float alikeness(const Eigen::Vector3f& point, const Eigen::Vector3f& camera) {
  const float cosine = point.dot(point - camera) / (point.norm() * (point - camera).norm() + 1e-9F);
  // Even a camera from the side shows what no other does.
  constexpr float least = 0.2F;
  return std::max(least, cosine);
}

}  // namespace

CameraChoice::CameraChoice(const Rig& rig)
    : user_(Lens(rig.color)),
      tiles_{0, 0, (rig.color.width + tile_px - 1) / tile_px,
             (rig.color.height + tile_px - 1) / tile_px} {
  const auto count =
      static_cast<std::size_t>(tiles_.width) * static_cast<std::size_t>(tiles_.height);
  wanted_.resize(count);
  for (const RgbdCamera& camera : rig.rgbd) {
    Camera& added = cameras_.emplace_back();
    added.measures_depth = camera.measures_depth;
    added.fx = static_cast<float>(camera.depth.fx);
    added.depth_unit_m = static_cast<float>(camera.depth_unit_m);
    if (rig.rgbd.size() <= usual_cameras) continue;
    added.rays = RayTable::of(camera.depth);
    added.worth.resize(count);
  }
}

void CameraChoice::mark_tiles(const Mask& mask, const Rect& objects) {
  for (int row = 0; row < tiles_.height; ++row) {
    for (int column = 0; column < tiles_.width; ++column) {
      bool shows_object = false;
      for (int i = 0; i < places * places && !shows_object; ++i) {
        const int x = column * tile_px + (i % places) * tile_px / places + tile_px / places / 2;
        const int y = row * tile_px + (i / places) * tile_px / places + tile_px / places / 2;
        shows_object = objects.contains(x, y) && mask(x, y) != 0;
      }
      wanted_[tile_at(column, row)] = shows_object;
    }
  }
}

void CameraChoice::look(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
                        std::size_t k) {
  Camera& camera = cameras_[k];
  const ImageView<std::uint16_t> depth = frame.rgbd[k].depth;
  const Mask& objects = masks.rgbd_depth[k];
  const FloatTransform user_from_depth(*poses.color_from_depth[k]);
  const Eigen::Vector3f place = poses.color_from_depth[k]->translation.cast<float>();
  const double age_s = std::abs(frame.rgbd[k].depth_stamp_s - frame.stamp_s);
  const auto freshness = static_cast<float>(std::exp2(-age_s / half_life_s));
  std::fill(camera.worth.begin(), camera.worth.end(), 0.F);
  struct Seen {
    Eigen::Vector3f point;
    float depth_m, u, v;
  };
  const auto see = [&](int x, int y, Seen& seen) {
    if (depth(x, y) == 0 || objects(x, y) != 0) return false;
    const float z = static_cast<float>(depth(x, y)) * camera.depth_unit_m;
    const Eigen::Vector2f ray = (*camera.rays)(x, y);
    for (int axis = 0; axis < 3; ++axis) {
      seen.point[axis] = user_from_depth.apply(axis, ray.x() * z, ray.y() * z, z);
    }
    seen.depth_m = z;
    const Eigen::Vector3f& point = seen.point;
    return point.z() > 0 &&
           user_.distort(point.x() / point.z(), point.y() / point.z(), seen.u, seen.v);
  };
  const auto raise = [&](int column, int row, const Eigen::Vector3f& point) {
    if (!tiles_.contains(column, row) || !wanted_[tile_at(column, row)]) return;
    float& best = camera.worth[tile_at(column, row)];
    best = std::max(best, freshness * alikeness(point, place));
  };
  const auto tile_of = [](float pixel) { return static_cast<int>(std::floor(pixel / tile_px)); };
  Seen seen;
  if (frame.rgbd[k].is_remote()) {
    const Glance& glance = frame.rgbd[k].remote->glance();
    for (const GlancePoint& point : glance.points) {
      if (!see(point.column, point.row, seen)) continue;
      // In the picture, from the point to half of the way to the next.
      const float reach_px = static_cast<float>(glance.point_step_px) * user_.fx / camera.fx *
                             seen.depth_m / seen.point.z() / 2;
      const float reach = std::floor(std::min(reach_px, most_reach_px));
      for (int row = tile_of(seen.v - reach); row <= tile_of(seen.v + reach); ++row) {
        for (int column = tile_of(seen.u - reach); column <= tile_of(seen.u + reach); ++column) {
          raise(column, row, seen.point);
        }
      }
    }
    return;
  }
  const int step = std::max(1, depth.width() / columns_of_image);
  for (int y = step / 2; y < depth.height(); y += step) {
    for (int x = step / 2; x < depth.width(); x += step) {
      if (see(x, y, seen)) raise(tile_of(seen.u), tile_of(seen.v), seen.point);
    }
  }
}

const std::vector<bool>& CameraChoice::find_spared(const FrameSet& frame, const Poses& poses,
                                                   const OcclusionMasks& masks,
                                                   const Rect& objects) {
  spared_.assign(cameras_.size(), false);
  if (cameras_.size() <= usual_cameras) return spared_;
  mark_tiles(masks.color, objects);
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    cameras_[k].is_used =
        !cameras_[k].measures_depth || !frame.rgbd[k].takes_part() || !poses.color_from_depth[k];
  }
  for_tasks(cameras_.size(), [&](std::size_t k) {
    if (!cameras_[k].is_used) look(frame, poses, masks, k);
  });
  const auto all = static_cast<float>(std::count(wanted_.begin(), wanted_.end(), true));
  best_.assign(wanted_.size(), 0.F);
  for (;;) {
    Camera* next = nullptr;
    float greatest = least_gain * all;
    for (Camera& camera : cameras_) {
      if (camera.is_used) continue;
      float gain = 0;
      for (std::size_t i = 0; i < best_.size(); ++i) {
        gain += std::max(0.F, camera.worth[i] - best_[i]);
      }
      if (gain <= greatest) continue;
      next = &camera;
      greatest = gain;
    }
    if (next == nullptr) break;
    next->is_used = true;
    for (std::size_t i = 0; i < best_.size(); ++i) {
      best_[i] = std::max(best_[i], next->worth[i]);
    }
  }
  for (std::size_t k = 0; k < cameras_.size(); ++k) spared_[k] = !cameras_[k].is_used;
  return spared_;
}

}  // namespace diminish
