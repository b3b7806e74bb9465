#include "bars/known_bars.h"

#include <algorithm>
#include <cmath>

#include "bars/bar_evidence.h"
#include "bars/bar_search.h"
#include "geometry/point_projection.h"

namespace diminish {
namespace {

constexpr int most_missed = 15;  ///< frames in which a bar is not found, before it is forgotten
/// Along it, from where it enters the mask: the places that are kept.
constexpr float outer_px = -20;
constexpr float inner_px = 60;
constexpr int longest_px = 400;  ///< from there to where it enters the mask in another frame

/// Moves its entry to where it enters the mask. False if it does not.
bool find_entry(const Mask& occlusion, Bar& bar) {
  const auto hidden = [&](int along) {
    return is_hidden(occlusion, bar.at(static_cast<float>(along), 0));
  };
  int along = 0;
  if (hidden(0)) {
    while (hidden(along)) {
      if (--along < -longest_px) return false;
    }
  } else {
    while (!hidden(along + 1)) {
      if (++along > longest_px) return false;
    }
  }
  bar.entry = bar.at(static_cast<float>(along), 0);
  return true;
}

}  // namespace

void KnownBars::forget() {
  const Turn::Held turn = turn_.hold(shared_->turns);
  shared_->bars.clear();
}

std::optional<Bar> KnownBars::in_picture(const Known& known, const RigidTransform& color_from_world,
                                         const BarViews& views) {
  const Eigen::Matrix3f rotation = color_from_world.rotation.cast<float>();
  const Eigen::Vector3f translation = color_from_world.translation.cast<float>();
  const auto place = [&](const Eigen::Vector3f& point_m) {
    return views.project(rotation * point_m + translation);
  };
  const std::array left{place(known.left[0]), place(known.left[1])};
  const std::array right{place(known.right[0]), place(known.right[1])};
  for (const auto& edge : {left, right}) {
    if (!edge[0] || !edge[1]) return std::nullopt;
  }
  Bar bar;
  bar.entry = (*left[0] + *right[0]) / 2;
  const Eigen::Vector2f along = (*left[1] + *right[1]) / 2 - bar.entry;
  if (along.norm() < 1) return std::nullopt;
  bar.inward = along.normalized();
  bar.width_px = bar.side(*right[0]) - bar.side(*left[0]);
  const Eigen::Vector3f normal = rotation * known.normal;
  bar.plane = {normal, normal.dot(rotation * known.left[0] + translation)};
  if (bar.plane.distance_m >= 0) return std::nullopt;
  return bar;
}

void KnownBars::recall(const RigidTransform& color_from_world, const BarViews& views,
                       const Mask& occlusion, std::vector<Bar>& bars) {
  turn_.wait(shared_->turns);
  bars.clear();
  for (const Known& known : shared_->bars) {
    auto bar = in_picture(known, color_from_world, views);
    if (bar && find_entry(occlusion, *bar)) bars.push_back(*bar);
  }
}

void KnownBars::keep(const RigidTransform& color_from_world, const BarViews& views,
                     const std::vector<Bar>& bars) {
  const Turn::Held turn = turn_.hold(shared_->turns);
  std::vector<Known>& all = shared_->bars;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](Known& known) {
                             if (++known.frames_missed > most_missed) return true;
                             const auto bar = in_picture(known, color_from_world, views);
                             return bar &&
                                    std::any_of(bars.begin(), bars.end(), [&](const Bar& other) {
                                      return exclude_each_other(views, *bar, other);
                                    });
                           }),
            all.end());
  const RigidTransform world_from_color = color_from_world.inverse();
  const Eigen::Matrix3f rotation = world_from_color.rotation.cast<float>();
  const Eigen::Vector3f translation = world_from_color.translation.cast<float>();
  for (const Bar& bar : bars) {
    const auto place = [&](float along, float side) -> Eigen::Vector3f {
      return rotation * meet(bar.plane, views.ray(bar.at(along, side))) + translation;
    };
    const float half = bar.width_px / 2;
    all.push_back({{place(outer_px, -half), place(inner_px, -half)},
                   {place(outer_px, half), place(inner_px, half)},
                   rotation * bar.plane.normal});
  }
}

}  // namespace diminish
