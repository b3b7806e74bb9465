#include "bars/bar_evidence.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace diminish {
namespace {

/// From one place along a bar to the next, pixels of the user's picture.
constexpr float place_px = 6;
constexpr int fewest_known = 8;
/// Shares are sorted out early if they are so much too small or too large.
constexpr float rounding = 1e-4F;
/// Beside the bar: so many pixels of the depth image away.
constexpr float flank_near = 2.4F;
constexpr float flank_far = 4.3F;

constexpr float edge_px = 1.5F;  ///< to both sides
constexpr int run = 5;           ///< of an edge's steps, in which it keeps its sign
constexpr int fewest_runs = 2;

constexpr float least_inverse = 1e-3F;  ///< of depth, 1/m: what is further away is nowhere

/// The numbers from 0 on whose bits are those of `i` from behind.
constexpr int spread(int i) {
  int result = 0;
  for (int bit = 1; bit < 32; bit *= 2, i /= 2) result = 2 * result + i % 2;
  return result;
}

}  // namespace

Eigen::Vector3f meet(const BackgroundPlane& plane, const Eigen::Vector3f& ray) {
  const float inverse = plane.inverse_depth(ray.x(), ray.y());
  return inverse > least_inverse ? Eigen::Vector3f(ray / inverse) : Eigen::Vector3f(0, 0, -1);
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
  const int count = std::min(Strip::most, static_cast<int>((end - begin) / step) + 1);
  static_assert(Strip::most == 32);
  for (int k = 0; k < Strip::most; ++k) {
    const int i = spread(k);
    if (i >= count) continue;
    const Eigen::Vector3f ray = views_.ray(bar.at(begin + static_cast<float>(i) * step, side));
    const auto at = static_cast<std::size_t>(result.count++);
    result.ray_x[at] = ray.x();
    result.ray_y[at] = ray.y();
  }
  return result;
}

std::optional<float> BarHole::bare_share(const Strip& strip, const BackgroundPlane& plane,
                                         float least, float most) const {
  int bare = 0;
  int solid = 0;
  int seen = 0;
  int rest = strip.count;
  const auto may_be = [&] {
    const auto known = static_cast<float>(bare + solid + seen + rest);
    return static_cast<float>(bare + solid + rest) >= (least - rounding) * known &&
           static_cast<float>(bare + solid) <= (most + rounding) * known && solid <= bare + rest;
  };
  constexpr int few = DepthView::few;
  for (int first = 0; rest > 0; first += few) {
    // Whole vectors of them: those beyond the last are at 0, where nothing is.
    const float* const ray_x = strip.ray_x.data() + first;
    const float* const ray_y = strip.ray_y.data() + first;
    const int count = std::min(few, rest);
    std::array<float, few> z_m{};
    for (int i = 0; i < count; ++i) {
      const float inverse = plane.inverse_depth(ray_x[i], ray_y[i]);
      z_m[static_cast<std::size_t>(i)] = inverse > least_inverse ? 1 / inverse : 0;
    }
    BarViews::Places places;
    views_.look_at({ray_x, ray_y, z_m.data(), few}, places);
    for (const BarViews::Place place : places) {
      bare += place == BarViews::Place::bare ? 1 : 0;
      solid += place == BarViews::Place::solid ? 1 : 0;
      seen += place == BarViews::Place::seen ? 1 : 0;
    }
    rest -= count;
    if (!may_be()) return std::nullopt;
  }
  const int known = bare + solid + seen;
  if (known < fewest_known) return std::nullopt;
  return static_cast<float>(bare + solid) / static_cast<float>(known);
}

float BarHole::margin(const BackgroundPlane& plane, float least) const {
  const auto on = bare_share(middle_, plane, least, 1);
  if (!on || *on < least) return 0;
  float beside = 0;
  for (const Side& side : sides_) {
    const float most = 2 * (*on - least);
    const float near = bare_share(side.near, plane, 0, most).value_or(1);
    if (near > most + rounding) return 0;
    const float far = bare_share(side.far, plane, 0, most - near).value_or(1);
    beside = std::max(beside, (near + far) / 2);
    if (*on - beside < least) return 0;
  }
  return *on - beside;
}

BarEdges::BarEdges(const BarViews& views, const Bar& bar, float begin, float end)
    : views_(views), places_(std::min(most, static_cast<int>((end - begin) / step_px) + 1)) {
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    const float side = (k == 0 ? -1.0F : 1.0F) * bar.width_px / 2;
    for (int i = 0; i < places_; ++i) {
      const float along = begin + static_cast<float>(i * step_px);
      edges_[k].left[static_cast<std::size_t>(i)] = views.ray(bar.at(along, side - edge_px));
      edges_[k].right[static_cast<std::size_t>(i)] = views.ray(bar.at(along, side + edge_px));
    }
  }
}

/// Of one edge in camera k.
float BarEdges::contrast(std::size_t k, const BackgroundPlane& plane, const Edge& edge) const {
  float sum = 0;
  int runs = 0;
  float step = 0;
  int steps = 0;
  for (int i = 0; i < places_; ++i) {
    const auto left = views_.level(k, meet(plane, edge.left[static_cast<std::size_t>(i)]));
    const auto right = views_.level(k, meet(plane, edge.right[static_cast<std::size_t>(i)]));
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

float BarEdges::contrast(const BackgroundPlane& plane, float least) const {
  float best = least;
  for (std::size_t k = 0; k < views_.size(); ++k) {
    const float left = contrast(k, plane, edges_[0]);
    if (left <= best) continue;
    best = std::max(best, std::min(left, contrast(k, plane, edges_[1])));
  }
  return best;
}

}  // namespace diminish
