#include "bars/bar_views.h"

#include <algorithm>
#include <cmath>

#include "core/bilinear.h"
#include "geometry/point_projection.h"

namespace diminish {
namespace {

/// A measurement this much further away is behind the place; one this much nearer hides it.
constexpr float behind_m = 0.015F;
constexpr float hiding_m = 0.06F;

float grey(const Bgr& color) {
  return 0.114F * color.b + 0.587F * color.g + 0.299F * color.r;
}

}  // namespace

BarViews::BarViews(const Rig& rig) : user_(Lens(rig.color)), rays_(rig.color) {
  for (const RgbdCamera& camera : rig.rgbd) {
    Camera& added = cameras_.emplace_back();
    added.depth_lens = Projection(Lens(camera.depth));
    added.color_lens = Projection(Lens(camera.color));
    added.unit_m = static_cast<float>(camera.depth_unit_m);
    added.measures = camera.measures_depth;
    added.color_from_depth = camera.color_from_depth;
    depth_pixel_px_ = std::max(depth_pixel_px_, user_.fx / added.depth_lens.fx);
  }
}

void BarViews::begin(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks) {
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    Camera& camera = cameras_[k];
    const auto& user_from_depth = poses.color_from_depth[k];
    camera.is_there = camera.measures && user_from_depth && frame.rgbd[k].available();
    if (!camera.is_there) continue;
    camera.depth = frame.rgbd[k].depth;
    camera.color = frame.rgbd[k].color;
    camera.depth_objects = masks.rgbd_depth[k];
    camera.color_objects = masks.rgbd_color[k];
    const RigidTransform depth_from_user = user_from_depth->inverse();
    camera.depth_from_user = FloatTransform(depth_from_user);
    camera.color_from_user = FloatTransform(camera.color_from_depth * depth_from_user);
    camera.centre = user_from_depth->translation.cast<float>();
  }
}

BarViews::Place BarViews::look_at(const Eigen::Vector3f& point_m) const {
  Place place = Place::unknown;
  for (const Camera& camera : cameras_) {
    if (!camera.is_there) continue;
    const Eigen::Vector3f point = transform(camera.depth_from_user, point_m);
    const auto pixel = diminish::project(camera.depth_lens, point);
    if (!pixel || !camera.depth.bounds().contains(pixel->x, pixel->y)) continue;
    const auto& [x, y] = *pixel;
    if (camera.depth_objects.bounds().contains(x, y) && camera.depth_objects(x, y) != 0) continue;
    const std::uint16_t value = camera.depth(x, y);
    const float measured_m = camera.unit_m * static_cast<float>(value);
    if (measured_m > point.z() + behind_m) return Place::seen;
    if (value != 0 && measured_m > point.z() - hiding_m) place = Place::solid;
    if (value == 0 && place == Place::unknown) place = Place::bare;
  }
  return place;
}

std::optional<float> BarViews::level(std::size_t k, const Eigen::Vector3f& point_m) const {
  const Camera& camera = cameras_[k];
  if (!camera.is_there) return std::nullopt;
  const auto at = project_exactly(camera.color_lens, transform(camera.color_from_user, point_m));
  const Rect inner = grow(camera.color.bounds(), -1);
  if (!at || !inner.contains(nearest_pixel(*at).x, nearest_pixel(*at).y)) return std::nullopt;
  const auto [x, y] = nearest_pixel(*at);
  if (camera.color_objects.bounds().contains(x, y) && camera.color_objects(x, y) != 0) {
    return std::nullopt;
  }
  return bilinear(at->x(), at->y(),
                  [&](int column, int row) { return grey(camera.color(column, row)); });
}

std::optional<Eigen::Vector3f> BarViews::centre(std::size_t k) const {
  if (!cameras_[k].is_there) return std::nullopt;
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
