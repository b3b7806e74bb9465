#include "scene/contact_line.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/convex_hull.h"

namespace diminish {
namespace {

/// Of places along the outline.
constexpr double step_px = 0.5;
/// Brightness is averaged over as many places on each side: wood has grain, and pictures noise.
constexpr int half_window = 12;
constexpr int fewest_in_window = half_window;
/// How far the plane is looked at beyond the line's reach, to tell how bright it is.
constexpr std::size_t beyond_px = 5;
/// The darkest part is within so many pixels of the mask.
constexpr int darkest_within_px = 3;
/// Lens distortion, the pose's error and rounding move the mask's rim by a little.
constexpr int slack_px = 4;

/// Of 255, four times.
float brightness(const Bgr& color) {
  return static_cast<float>(color.b + 2 * color.g + color.r);
}

Eigen::Vector2i pixel_at(const Eigen::Vector2d& point) {
  return {static_cast<int>(std::lround(point.x())), static_cast<int>(std::lround(point.y()))};
}

}  // namespace

void ContactLine::find(const Inputs& inputs) {
  pixels_.clear();
  if (inputs.reach_px == 0) return;
  for (const std::vector<Eigen::Vector3d>& object_m : inputs.objects_m) {
    for (const BackgroundPlane& plane : inputs.planes) {
      if (!find_outline(object_m, plane)) continue;
      list_places();
      if (places_.empty()) continue;
      measure(inputs);
      find_widths(inputs.reach_px);
      drop_short_ones();
      list_pixels(inputs.mask);
    }
  }
}

/// Of the object's vertices that are on the plane. False if they are none, or out of sight.
bool ContactLine::find_outline(const std::vector<Eigen::Vector3d>& object_m,
                               const BackgroundPlane& plane) {
  foot_.clear();
  for (const Eigen::Vector3d& vertex_m : object_m) {
    if (!BackgroundPlanes::lies_on(plane, vertex_m.cast<float>())) continue;
    const auto pixel = lens_.project(vertex_m);
    if (!pixel) return false;
    foot_.push_back(*pixel);
  }
  find_convex_hull(foot_, hull_);
  return hull_.size() >= 2;
}

/// All around, and around the corners.
void ContactLine::list_places() {
  places_.clear();
  const std::size_t size = hull_.size();
  const auto side = [&](std::size_t i) -> Eigen::Vector2d {
    return hull_[(i + 1) % size] - hull_[i % size];
  };
  const auto outward_of = [](const Eigen::Vector2d& along) -> Eigen::Vector2d {
    return Eigen::Vector2d(along.y(), -along.x()).normalized();
  };
  constexpr double turn = 0.05;  // half a pixel, ten pixels away
  for (std::size_t i = 0; i < size; ++i) {
    const Eigen::Vector2d along = side(i);
    const Eigen::Vector2d outward = outward_of(along);
    const auto steps = static_cast<int>(std::ceil(along.norm() / step_px));
    // What is far outside the picture is not walked along.
    if (steps > 4 * (lens_.intrinsics().width + lens_.intrinsics().height)) continue;
    for (int k = 0; k < steps; ++k) places_.push_back({hull_[i] + along * k / steps, outward});
    const Eigen::Vector2d next = outward_of(side(i + 1));
    const double angle = std::acos(std::clamp(outward.dot(next), -1., 1.));
    const auto turns = static_cast<int>(angle / turn);
    for (int k = 0; k < turns; ++k) {
      const Eigen::Rotation2Dd rotation(angle * k / turns);
      places_.push_back({hull_[(i + 1) % size], rotation * outward});
    }
  }
}

/// Brightness from the mask's end on.
void ContactLine::measure(const Inputs& inputs) {
  const auto count = static_cast<std::size_t>(inputs.reach_px) + beyond_px;
  levels_.assign(places_.size() * count, 0);
  const Rect picture = inputs.mask.bounds();
  const auto is_masked = [&](const Eigen::Vector2i& at) {
    return picture.contains(at.x(), at.y()) && inputs.mask(at.x(), at.y()) != 0;
  };
  for (std::size_t i = 0; i < places_.size(); ++i) {
    Place& place = places_[i];
    const auto at = [&](int px) { return pixel_at(place.pixel + place.outward * px); };
    place.first_px = -1;
    if (!is_masked(at(0))) continue;
    int end = 1;
    const int last = inputs.margin_px + slack_px;
    while (end <= last && is_masked(at(end))) ++end;
    if (end > last) continue;
    bool is_clear = true;
    for (std::size_t k = 0; k < count && is_clear; ++k) {
      const Eigen::Vector2i pixel = at(end + static_cast<int>(k));
      is_clear = picture.contains(pixel.x(), pixel.y()) && !is_masked(pixel);
      if (is_clear) levels_[i * count + k] = brightness(inputs.camera(pixel.x(), pixel.y()));
    }
    if (is_clear) place.first_px = end;
  }
}

void ContactLine::find_widths(int reach_px) {
  const auto count = static_cast<std::size_t>(reach_px) + beyond_px;
  const auto size = static_cast<int>(places_.size());
  sums_.assign(count, 0);
  int measured = 0;
  const auto add = [&](int i, int sign) {
    const auto place = static_cast<std::size_t>((i % size + size) % size);
    if (places_[place].first_px < 0) return;
    measured += sign;
    for (std::size_t k = 0; k < count; ++k) {
      sums_[k] += static_cast<float>(sign) * levels_[place * count + k];
    }
  };
  for (int i = -half_window; i < half_window; ++i) add(i, 1);
  for (int i = 0; i < size; ++i) {
    add(i + half_window, 1);
    Place& place = places_[static_cast<std::size_t>(i)];
    place.width_px = -1;
    if (place.first_px >= 0 && measured >= fewest_in_window) {
      const auto plane = sums_.begin() + reach_px;
      float level = 0;
      for (auto sum = plane; sum != sums_.end(); ++sum) level += *sum / beyond_px;
      const auto darkest =
          std::min_element(sums_.begin(), sums_.begin() + std::min(darkest_within_px, reach_px));
      const auto end =
          std::find_if(darkest, plane, [&](float sum) { return sum >= bright * level; });
      if (*darkest < dark * level && end != plane) {
        place.width_px = static_cast<int>(end - sums_.begin());
      }
    }
    add(i - half_window, -1);
  }
}

void ContactLine::drop_short_ones() {
  constexpr auto least = static_cast<std::size_t>(least_length_px / step_px);
  for (std::size_t begin = 0; begin < places_.size();) {
    std::size_t end = begin;
    while (end < places_.size() && places_[end].width_px >= 0) ++end;
    if (end - begin < least) {
      for (std::size_t i = begin; i < end; ++i) places_[i].width_px = -1;
    }
    begin = end + 1;
  }
}

void ContactLine::list_pixels(const Mask& mask) {
  for (const Place& place : places_) {
    for (int k = 0; k <= place.width_px; ++k) {
      const Eigen::Vector2i at = pixel_at(place.pixel + place.outward * (place.first_px + k));
      if (mask.bounds().contains(at.x(), at.y()) && mask(at.x(), at.y()) == 0) {
        pixels_.push_back(at);
      }
    }
  }
}

}  // namespace diminish
