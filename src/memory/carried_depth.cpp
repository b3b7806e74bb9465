#include "memory/carried_depth.h"

#include <algorithm>
#include <cmath>

#include "core/channels.h"
#include "memory/light.h"

namespace diminish {

CarriedDepth::CarriedDepth(const KeyframeGrid& grid) : grid_(grid) {}

bool CarriedDepth::looks_like(const Bgr& color, const Image<Bgr>& picture, const Pixel& place) {
  constexpr float tolerance = 20;  // levels
  constexpr float shadow = 0.6F;   // of an object to remove, which comes and goes
  const Eigen::Array3f then = to_channels(color);
  const Rect around = intersect(grow({place.x, place.y, 1, 1}, 1), picture.bounds());
  for (int y = around.y; y < around.bottom(); ++y) {
    for (int x = around.x; x < around.right(); ++x) {
      const Eigen::Array3f now = to_channels(picture(x, y));
      const float light = std::clamp(light_between(now, then, 1 / shadow), shadow, 1 / shadow);
      if (((light * then - now).abs() <= tolerance).all()) return true;
    }
  }
  return false;
}

void CarriedDepth::fill(const RigidTransform& color_from_world, const Image<Bgr>& picture,
                        const Mask& objects, Image<float>& inverse_depth) {
  const Rect bounds = inverse_depth.bounds();
  const int step = grid_.step();
  now_.resize(bounds.width, bounds.height, Place{});
  const FloatTransform now_from_then(color_from_world * color_from_world_.inverse());
  for (const Place& then : places_) {
    if (then.point_m.z() == 0) continue;
    const Eigen::Vector3f point_m = transform(now_from_then, then.point_m);
    const auto place = project(grid_.lens(), point_m);
    if (!place || !bounds.contains(place->x, place->y)) continue;
    const bool is_hidden = objects(place->x * step, place->y * step) != 0;
    const float measured = inverse_depth(place->x, place->y);
    if (is_hidden) {
      const float tolerance_m = between_cameras.at(point_m.z());
      if (measured > 0 && std::abs(1 / measured - point_m.z()) > tolerance_m) continue;
    } else if (measured > 0 || !looks_like(then.color, picture, *place)) {
      continue;
    }
    Place& now = now_(place->x, place->y);
    if (now.point_m.z() == 0 || point_m.z() < now.point_m.z()) now = {point_m, then.color};
  }
  for (int y = 0; y < bounds.height; ++y) {
    for (int x = 0; x < bounds.width; ++x) {
      if (objects(x * step, y * step) != 0) continue;
      Place& place = now_(x, y);
      float& inverse_z = inverse_depth(x, y);
      if (inverse_z > 0) {
        const Eigen::Vector2f ray = grid_.ray(x, y);
        place.point_m = Eigen::Vector3f(ray.x(), ray.y(), 1) / inverse_z;
      }
      if (place.point_m.z() == 0) continue;
      place.color = picture(x, y);
      inverse_z = 1 / place.point_m.z();
    }
  }
  color_from_world_ = color_from_world;
  std::swap(places_, now_);
}

}  // namespace diminish
