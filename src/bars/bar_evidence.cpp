#include "bars/bar_evidence.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace diminish {
namespace {

/// From one place along a bar to the next, pixels of the user's picture.
constexpr float place_px = 6;
constexpr int fewest_known = 8;
/// The share of places without depth on a bar at least, before those beside it are looked at.
constexpr float least_bare = 0.5F;
/// Beside the bar: so many pixels of the depth image away.
constexpr float flank_near = 2.4F;
constexpr float flank_far = 4.3F;

constexpr float edge_px = 1.5F;  ///< to both sides
constexpr float edge_step_px = 5;
constexpr int run = 5;  ///< of these steps, in which an edge keeps its sign
constexpr int fewest_runs = 2;

/// The same of one edge in camera k.
float edge_contrast(const BarViews& views, std::size_t k, const Bar& bar, float begin, float end,
                    float side) {
  float sum = 0;
  int runs = 0;
  float step = 0;
  int steps = 0;
  const int places = static_cast<int>((end - begin) / edge_step_px) + 1;
  for (int i = 0; i < places; ++i) {
    const float along = begin + static_cast<float>(i) * edge_step_px;
    const auto left = views.level(k, meet(bar.plane, views.ray(bar.at(along, side - edge_px))));
    const auto right = views.level(k, meet(bar.plane, views.ray(bar.at(along, side + edge_px))));
    if (left && right) {
      step += *right - *left;
      ++steps;
    }
    if ((i + 1) % run != 0) continue;
    if (steps > run / 2) {
      sum += std::abs(step) / static_cast<float>(steps);
      ++runs;
    }
    step = 0;
    steps = 0;
  }
  return runs < fewest_runs ? 0 : sum / static_cast<float>(runs);
}

}  // namespace

Eigen::Vector3f meet(const BackgroundPlane& plane, const Eigen::Vector3f& ray) {
  const float inverse = plane.inverse_depth(ray.x(), ray.y());
  return inverse > 1e-3F ? Eigen::Vector3f(ray / inverse) : Eigen::Vector3f(0, 0, -1);
}

BarHole::BarHole(const BarViews& views, const Bar& bar, float begin, float end)
    : views_(views), middle_(strip(bar, begin, end, 0)) {
  const float half = bar.width_px / 2;
  const float pixel = views.depth_pixel_px();
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const float sign = i == 0 ? -1.0F : 1.0F;
    sides_[i] = {strip(bar, begin, end, sign * (half + flank_near * pixel)),
                 strip(bar, begin, end, sign * (half + flank_far * pixel))};
  }
}

BarHole::Strip BarHole::strip(const Bar& bar, float begin, float end, float side) const {
  Strip result;
  const float step = std::max(place_px, (end - begin) / (Strip::most - 1));
  result.count = std::min(Strip::most, static_cast<int>((end - begin) / step) + 1);
  for (int i = 0; i < result.count; ++i) {
    result.rays[static_cast<std::size_t>(i)] =
        views_.ray(bar.at(begin + static_cast<float>(i) * step, side));
  }
  return result;
}

std::optional<float> BarHole::bare_share(const Strip& strip, const BackgroundPlane& plane) const {
  int bare = 0;
  int solid = 0;
  int seen = 0;
  for (int i = 0; i < strip.count; ++i) {
    const auto place = views_.look_at(meet(plane, strip.rays[static_cast<std::size_t>(i)]));
    bare += place == BarViews::Place::bare ? 1 : 0;
    solid += place == BarViews::Place::solid ? 1 : 0;
    seen += place == BarViews::Place::seen ? 1 : 0;
  }
  const int known = bare + solid + seen;
  if (known < fewest_known || solid > bare) return std::nullopt;
  return static_cast<float>(bare + solid) / static_cast<float>(known);
}

float BarHole::margin(const BackgroundPlane& plane) const {
  const auto on = bare_share(middle_, plane);
  if (!on || *on < least_bare) return 0;
  float beside = 0;
  for (const Side& side : sides_) {
    const auto near = bare_share(side.near, plane);
    const auto far = bare_share(side.far, plane);
    beside = std::max(beside, (near.value_or(1) + far.value_or(1)) / 2);
  }
  return *on - beside;
}

float edge_contrast(const BarViews& views, const Bar& bar, float begin, float end) {
  float best = 0;
  for (std::size_t k = 0; k < views.size(); ++k) {
    const float left = edge_contrast(views, k, bar, begin, end, -bar.width_px / 2);
    if (left <= best) continue;
    const float right = edge_contrast(views, k, bar, begin, end, bar.width_px / 2);
    best = std::max(best, std::min(left, right));
  }
  return best;
}

}  // namespace diminish
