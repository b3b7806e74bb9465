#include "bars/bar_views.h"

#include <algorithm>
#include <cmath>

#include "core/bilinear.h"
#include "core/channels.h"
#include "core/shrunk_picture.h"

namespace diminish {
namespace {

/// A measurement this much further away is behind the place; one this much nearer hides it.
constexpr float behind_m = 0.015F;
constexpr float hiding_m = 0.06F;

}  // namespace

BarViews::BarViews(const Rig& rig)
    : user_(Lens(rig.color)), rays_(rig.color), pixel_rays_(RayTable::of(rig.color)) {
  for (const RgbdCamera& camera : rig.rgbd) {
    cameras_.emplace_back(camera);
    depth_pixel_px_ = std::max(depth_pixel_px_, user_.fx / static_cast<float>(camera.depth.fx));
  }
}

void BarViews::begin(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks) {
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    Camera& camera = cameras_[k];
    camera.depth.clear();
    const auto& user_from_depth = poses.color_from_depth[k];
    if (!camera.rig.measures_depth || !user_from_depth || !frame.rgbd[k].available()) continue;
    const RigidTransform depth_from_user = user_from_depth->inverse();
    camera.depth.begin(frame.rgbd[k].depth, masks.rgbd_depth[k], depth_from_user);
    camera.color = frame.rgbd[k].color;
    camera.color_objects = masks.rgbd_color[k];
    camera.color_from_user = FloatTransform(camera.rig.color_from_depth * depth_from_user);
    camera.centre = user_from_depth->translation.cast<float>();
  }
}

BarViews::Place BarViews::add(Place so_far, const DepthView::Depth& depth) {
  if (so_far == Place::seen) return so_far;
  const float measured_m = depth.measured_m;
  const float own_m = depth.own_m;
  if (measured_m > own_m + behind_m) return Place::seen;
  if (measured_m == 0) return so_far == Place::unknown ? Place::bare : so_far;
  return measured_m > own_m - hiding_m ? Place::solid : so_far;
}

BarViews::Place BarViews::look_at(const Eigen::Vector3f& point_m) const {
  Place place = Place::unknown;
  for (const Camera& camera : cameras_) {
    if (const auto depth = camera.depth.at(point_m)) place = add(place, *depth);
  }
  return place;
}

void BarViews::look_at(const PointRow& points, Places& places) const {
  places.fill(Place::unknown);
  for (const Camera& camera : cameras_) {
    camera.depth.for_each(points, [&](std::size_t i, const DepthView::Depth& depth) {
      places[i] = add(places[i], depth);
    });
  }
}

std::optional<Eigen::Vector2f> BarViews::in_picture(const Camera& camera,
                                                    const Eigen::Vector3f& point_m) {
  if (camera.depth.empty()) return std::nullopt;
  auto at = project_exactly(camera.color_lens, transform(camera.color_from_user, point_m));
  const Rect inner = grow(camera.color.bounds(), -1);
  if (!at || !inner.contains(nearest_pixel(*at).x, nearest_pixel(*at).y)) return std::nullopt;
  const auto [x, y] = nearest_pixel(*at);
  if (camera.color_objects.bounds().contains(x, y) && camera.color_objects(x, y) != 0) {
    return std::nullopt;
  }
  return at;
}

std::optional<float> BarViews::level(std::size_t k, const Eigen::Vector3f& point_m) const {
  const auto at = in_picture(cameras_[k], point_m);
  if (!at) return std::nullopt;
  return bilinear(at->x(), at->y(), [&](int column, int row) {
    const Bgr& color = cameras_[k].color(column, row);
    return brightness(color.b, color.g, color.r);
  });
}

std::optional<Eigen::Array3f> BarViews::color(std::size_t k, const Eigen::Vector3f& point_m) const {
  const auto at = in_picture(cameras_[k], point_m);
  if (!at) return std::nullopt;
  return bilinear(at->x(), at->y(), [&](int column, int row) -> Eigen::Array3f {
    return to_channels(cameras_[k].color(column, row));
  });
}

bool BarViews::is_in_gap(std::size_t k, const DepthView::Depth& bare) const {
  constexpr float tolerance = 0.03F;
  constexpr float tolerance_m = 0.02F;
  return cameras_[k].depth.is_in_gap(bare, tolerance, tolerance_m);
}

std::optional<Eigen::Vector3f> BarViews::centre(std::size_t k) const {
  if (cameras_[k].depth.empty()) return std::nullopt;
  return cameras_[k].centre;
}

std::optional<Eigen::Vector2f> BarViews::project(const Eigen::Vector3f& point_m) const {
  return project_exactly(user_, point_m);
}

Eigen::Vector3f BarViews::ray(const Eigen::Vector2f& at) const {
  const Image<Eigen::Vector2f>& nodes = rays_.nodes();
  const float x =
      std::clamp(at.x() / RayGrid::step, 0.0F, static_cast<float>(nodes.width()) - 1.01F);
  const float y =
      std::clamp(at.y() / RayGrid::step, 0.0F, static_cast<float>(nodes.height()) - 1.01F);
  const Eigen::Vector2f ray =
      bilinear(x, y, [&](int column, int row) -> Eigen::Vector2f { return nodes(column, row); });
  return {ray.x(), ray.y(), 1};
}

}  // namespace diminish
