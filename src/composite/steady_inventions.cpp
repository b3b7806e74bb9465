#include "composite/steady_inventions.h"

#include <algorithm>
#include <cmath>

#include "composite/mix_inventions.h"
#include "core/rows.h"
#include "core/runs.h"
#include "geometry/point_projection.h"

namespace diminish {
namespace {

/// After this time, half of what is shown comes from later frames. It is short, because mixing
/// fillings that differ for long blurs their edges.
constexpr double half_life_s = 0.035;
/// Between frames that follow one another.
constexpr double longest_s = 0.5;

bool has_depth(std::uint8_t label) {
  return label != surface_label::unknown && label != surface_label::foreground;
}

/// The depth of what is invented at a pixel with such a label; 0 if it is behind the camera.
float depth_at(const Surfaces& surfaces, const std::vector<BackgroundPlane>& planes,
               const Eigen::Vector2f& ray, int x, int y) {
  const std::uint8_t label = surfaces.label(x, y);
  if (label == surface_label::standing) return surfaces.standing_depth_m(x, y);
  const float inverse = planes[label - surface_label::first_plane].inverse_depth(ray.x(), ray.y());
  return inverse > 0 ? 1 / inverse : 0;
}

}  // namespace

void SteadyInventions::forget() {
  const Turn::Held turn = turn_.hold(shared_->turns);
  shared_->color_from_world.reset();
}

void SteadyInventions::steady(const Inputs& inputs, DiminishedFrame& result) {
  const Turn::Held turn = turn_.hold(shared_->turns);
  mix(inputs, result);
  keep(inputs, result);
}

void SteadyInventions::mix(const Inputs& inputs, DiminishedFrame& result) const {
  const Shared& last = *shared_;
  const double since_s = inputs.stamp_s - last.stamp_s;
  if (!last.color_from_world || !inputs.color_from_world || inputs.planes == nullptr ||
      !(since_s > 0 && since_s < longest_s) || last.part.empty() || result.surfaces.label.empty()) {
    return;
  }
  const auto share = static_cast<int>(std::lrint(256 * std::exp2(-since_s / half_life_s)));
  const FloatTransform last_from_now(*last.color_from_world * inputs.color_from_world->inverse());
  const Rect part = intersect(inputs.objects, result.surfaces.region);
  const EarlierInventions earlier{last.picture, last.part};
  const auto place_before = [&](int x, int y) {
    const Eigen::Vector2f ray = (*rays_)(x, y);
    const float z = depth_at(result.surfaces, *inputs.planes, ray, x, y);
    const Eigen::Vector3f point(z * ray.x(), z * ray.y(), z);
    return project_exactly(lens_, transform(last_from_now, point));
  };
  const auto mix_row = [&](int y, std::uint8_t kind) {
    const std::uint8_t* const label = result.surfaces.label.row(y);
    const std::uint8_t* const origin = result.provenance.row(y);
    for (int x = part.x; x < part.right(); ++x) {
      x = find_equal(origin, x, part.right(), kind);
      if (x == part.right()) break;
      const int first = x;
      const int end = std::min(part.right(), first + InventionRun::most);
      x = std::min(find_other(origin, first, end, kind),
                   find_other(label, first, end, label[first])) -
          1;
      if (!has_depth(label[x])) continue;
      // Along a short run, places of the last frame lie evenly.
      const std::optional<Eigen::Vector2f> from = place_before(first, y);
      const std::optional<Eigen::Vector2f> to = x > first ? place_before(x, y) : from;
      if (!from || !to) continue;
      const Eigen::Vector2f step = (*to - *from) / static_cast<float>(std::max(1, x - first));
      mix_inventions(earlier, {*from, step, x - first + 1}, share, result.picture.row(y) + first);
    }
  };
  for_rows(part.height, [&](Rows rows) {
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      mix_row(y, provenance::inpainted);
      // Bars lie so near their planes that these tell where they were.
      if (result.report.estimated_pixels > 0) mix_row(y, provenance::estimated);
    }
  });
}

void SteadyInventions::keep(const Inputs& inputs, const DiminishedFrame& result) {
  Shared& last = *shared_;
  last.stamp_s = inputs.stamp_s;
  last.color_from_world = inputs.color_from_world;
  last.part = intersect(inputs.objects, result.picture.bounds());
  last.picture.resize(result.picture.width(), result.picture.height());
  for_rows(last.part.height, [&](Rows rows) {
    for (int y = last.part.y + rows.first; y < last.part.y + rows.last; ++y) {
      keep_inventions(result.picture.row(y) + last.part.x, result.provenance.row(y) + last.part.x,
                      last.part.width, last.picture.row(y) + last.part.x);
    }
  });
}

}  // namespace diminish
