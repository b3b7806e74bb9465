#include "detect/difference/evidence_history.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/rows.h"
#include "geometry/shrunk_camera.h"

namespace diminish {
namespace {

constexpr std::size_t most_moments = 8;
constexpr double longest_s = 1;
/// By how many frames those that saw the scene must outnumber the others, this one included: what
/// has really changed is believed after a few.
constexpr int least_lead = 3;

}  // namespace

EvidenceHistory::EvidenceHistory(const Intrinsics& color, int shrinkage)
    : moments_(most_moments + 1),
      projection_(Lens(shrunk_camera(color, shrinkage))),
      rays_(RayTable::of(shrunk_camera(color, shrinkage))) {}

void EvidenceHistory::steady(const Inputs& inputs, const Rect& part, Image<Shown>& shown) {
  begin(inputs, shown);
  for_rows(part.height, [&](Rows rows) {
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      for (int x = part.x; x < part.right(); ++x) {
        if (is_object(shown(x, y)) && was_scene(inputs, x, y)) shown(x, y) = Shown::scene;
      }
    }
  });
  std::rotate(moments_.begin(), moments_.end() - 1, moments_.end());
  known_ = std::min(known_ + 1, most_moments);
}

/// Keeps this frame, and forgets what is too long ago, or comes after it.
void EvidenceHistory::begin(const Inputs& inputs, const Image<Shown>& shown) {
  const auto is_of_use = [&](const Moment& then) {
    return then.stamp_s < inputs.stamp_s && then.stamp_s >= inputs.stamp_s - longest_s;
  };
  const auto end = moments_.begin() + static_cast<std::ptrdiff_t>(known_);
  known_ = static_cast<std::size_t>(std::find_if_not(moments_.begin(), end, is_of_use) -
                                    moments_.begin());
  const RigidTransform world_from_color = inputs.color_from_world.inverse();
  for (std::size_t i = 0; i < known_; ++i) {
    moments_[i].from_now = FloatTransform(moments_[i].color_from_world * world_from_color);
  }
  Moment& now = moments_.back();
  now.stamp_s = inputs.stamp_s;
  now.color_from_world = inputs.color_from_world;
  now.picture = inputs.picture;
  now.shown = shown;
}

bool EvidenceHistory::was_scene(const Inputs& inputs, int x, int y) const {
  const SeenSurface& nearest = inputs.layers.nearest(x, y);
  if (nearest.source == 0) return false;
  const bool is_nearest = inputs.evidence.looks_like_nearest(x, y);
  const float depth_m = is_nearest ? nearest.depth_m : inputs.layers.farthest(x, y).depth_m;
  const Eigen::Vector3f point_m = depth_m * (*rays_)(x, y).homogeneous();
  int lead = -1;
  for (std::size_t i = 0; i < known_; ++i) {
    if (lead + static_cast<int>(known_ - i) < least_lead) return false;
    const Shown then = recall(moments_[i], point_m, inputs, x, y);
    if (then == Shown::scene) ++lead;
    if (is_object(then)) --lead;
  }
  return lead >= least_lead;
}

Shown EvidenceHistory::recall(const Moment& then, const Eigen::Vector3f& point_m,
                              const Inputs& inputs, int x, int y) const {
  const auto pixel = project(projection_, transform(then.from_now, point_m));
  if (!pixel || !then.picture.bounds().contains(pixel->x, pixel->y)) return Shown::unknown;
  const auto& [column, row] = *pixel;
  if (!inputs.evidence.looks_like(then.picture(column, row), x, y)) return Shown::unknown;
  // Between surfaces nothing is certain, but beside it.
  for (const auto& [dx, dy] : {std::pair{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    if (!then.shown.bounds().contains(column + dx, row + dy)) continue;
    const Shown beside = then.shown(column + dx, row + dy);
    if (beside == Shown::scene || is_object(beside)) return beside;
  }
  return Shown::unknown;
}

}  // namespace diminish
