#include "scene/standing_things.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/conditions.h"
#include "core/rows.h"
#include "core/runs.h"
#include "depth/depth_noise.h"
#include "diminish/diminished_frame.h"
#include "scene/thing_step.h"

namespace diminish {
namespace {

/// A plane on which things stand faces at least this far up in the picture (cosine).
constexpr float least_up = 0.35F;
constexpr float lowest_top_m = 0.02F;
/// A top rises less steeply than this.
constexpr float top_slope = 0.3F;
/// Pixels to each side at which a top's slope is measured: far enough for the noise in depth.
constexpr int slope_px[] = {-8, -6, -5, -4, 4, 5, 6, 8};
/// Places below a top's edge that are looked at.
constexpr int places = 9;
constexpr int most_empty = 1;
constexpr int fewest_hidden = 5;
/// What hides a place below a top is the same thing if it is no further away than this.
constexpr float deepest_m = 0.5F;
/// A camera looks through a place if it measures something this far behind it.
constexpr DepthNoise behind{0.03F, 0.01F};
constexpr int widest_slit_px = 24;
/// From one side of a slit to the other: what is seen of a thing may be its front, and its side
/// hang from the far end of its top.
constexpr float slit_step_m = 3 * thing_step_m;
constexpr int rows_together = 16;

const BackgroundPlane* find_support(const std::vector<BackgroundPlane>& planes) {
  const BackgroundPlane* best = nullptr;
  for (const BackgroundPlane& plane : planes) {
    const float up = -plane.normal.y();
    if (up >= least_up && (best == nullptr || up > -best->normal.y())) best = &plane;
  }
  return best;
}

/// The nearest of all sides, whichever thread comes first.
void lower_to(float z_m, float& side_m, std::uint8_t& label) {
  const std::atomic_ref<float> side(side_m);
  float before = side.load(std::memory_order_relaxed);
  while (before == 0 || z_m < before) {
    if (!side.compare_exchange_weak(before, z_m, std::memory_order_relaxed)) continue;
    std::atomic_ref<std::uint8_t>(label).store(surface_label::standing, std::memory_order_relaxed);
    return;
  }
}

}  // namespace

/// What a frame looks like.
struct StandingThings::View {
  const Input& input;
  const BackgroundPlane& plane;
  const Image<std::uint8_t>& label;  ///< without sides
  Rect part;                         ///< of the mask's box, what was drawn

  float depth_m(int x, int y) const { return input.reconstruction.depth_m(x, y); }
  /// What is only remembered may have gone.
  bool is_remembered(int x, int y) const {
    return input.reconstruction.source(x, y) == provenance::remembered;
  }
  /// Whether something at this depth hides what was drawn at a pixel.
  bool hides(int x, int y, float z_m) const {
    return input.masks.color(x, y) != 0 &&
           hides_at(y * std::ptrdiff_t{input.reconstruction.depth_m.width()} + x, z_m);
  }
  /// The same of a pixel of the mask. at: y * width + x.
  bool hides_at(std::ptrdiff_t at, float z_m) const {
    const float drawn = input.reconstruction.depth_m.data()[at];
    if (drawn == 0) return true;
    const std::uint8_t source = input.reconstruction.source.data()[at];
    return drawn > z_m + thing_step_m && source != provenance::witnessed &&
           source != provenance::remembered;
  }
};

StandingThings::StandingThings(const Rig& rig)
    : color_(Lens(rig.color)), rays_(RayTable::of(rig.color)) {
  for (const RgbdCamera& camera : rig.rgbd) {
    cameras_.push_back({DepthView(camera), Eigen::Vector3f::Zero()});
  }
}

void StandingThings::place_cameras(const Input& input) {
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    Camera& camera = cameras_[k];
    camera.depth.clear();
    const auto& color_from_depth = input.poses.color_from_depth[k];
    if (!color_from_depth || !input.frame.rgbd[k].available()) continue;
    camera.depth.begin(input.frame.rgbd[k].depth, input.masks.rgbd_depth[k],
                       color_from_depth->inverse());
    camera.centre = color_from_depth->translation.cast<float>();
  }
}

/// What an RGB-D camera says of a place below a top of this height.
StandingThings::Place StandingThings::look_at(const View& view, const Camera& camera,
                                              const Eigen::Vector3f& point_m, float top_height_m) {
  const auto depth = camera.depth.at(point_m);
  if (!depth || depth->measured_m == 0) return Place::unknown;
  const float measured = depth->measured_m;
  const float own = depth->own_m;
  if (measured > own + behind.at(own)) return Place::empty;
  const Eigen::Vector3f hider = camera.centre + measured / own * (point_m - camera.centre);
  const bool is_side = view.plane.height_m(hider) < top_height_m - lowest_top_m &&
                       (point_m - hider).norm() < deepest_m;
  return is_side ? Place::hidden_by_side : Place::unknown;
}

/// Whether what is below a top's edge belongs to the same thing.
bool StandingThings::is_solid(const View& view, const Eigen::Vector3f& top_m,
                              float height_m) const {
  int empty = 0;
  int hidden = 0;
  for (int i = 1; i <= places; ++i) {
    const float below_m = static_cast<float>(i) / (places + 1) * height_m;
    const Eigen::Vector3f point = top_m - below_m * view.plane.normal;
    bool is_hidden = false;
    for (const Camera& camera : cameras_) {
      const Place place = look_at(view, camera, point, height_m);
      is_hidden |= place == Place::hidden_by_side;
      if (place == Place::empty && ++empty > most_empty) return false;
    }
    hidden += is_hidden ? 1 : 0;
  }
  return hidden >= fewest_hidden;
}

/// Whether the thing is level around a pixel of its edge: a box or a cup is, a ball is not.
bool StandingThings::is_top(const View& view, int x, int y) const {
  const auto point = [&](int column, int row) -> Eigen::Vector3f {
    const Eigen::Vector2f ray = (*rays_)(column, row);
    return view.depth_m(column, row) * Eigen::Vector3f(ray.x(), ray.y(), 1);
  };
  const Eigen::Vector3f here = point(x, y);
  const auto is_level = [&](int column, int row) {
    if (!view.part.contains(column, row)) return false;
    if (view.label(column, row) != surface_label::foreground ||
        !(std::abs(view.depth_m(column, row) - here.z()) < thing_step_m)) {
      return false;
    }
    const Eigen::Vector3f between = point(column, row) - here;
    return std::abs(view.plane.normal.dot(between)) < top_slope * between.norm();
  };
  const auto any = [&](const auto& is_level_at) {
    return std::any_of(std::begin(slope_px), std::end(slope_px), is_level_at);
  };
  return any([&](int rows) { return is_level(x, y + rows); }) &&
         any([&](int columns) { return is_level(x + columns, y); });
}

/// Labels what is below a pixel of a top's edge.
void StandingThings::lower(const View& view, int x, int y, Surfaces& surfaces) const {
  const Eigen::Vector2f ray = (*rays_)(x, y);
  const Eigen::Vector3f top = view.depth_m(x, y) * Eigen::Vector3f(ray.x(), ray.y(), 1);
  const float height_m = view.plane.height_m(top);
  if (height_m < lowest_top_m) return;
  const Eigen::Vector3f foot = top - height_m * view.plane.normal;
  const auto end = project_exactly(color_, foot);
  if (!end) return;
  const Eigen::Vector2f start(static_cast<float>(x), static_cast<float>(y));
  const Eigen::Vector2f way = *end - start;
  const auto steps = static_cast<int>(std::ceil(way.lpNorm<Eigen::Infinity>()));
  // 1 / z is linear along a line in the picture.
  const float at_top = 1 / top.z();
  const float to_foot = 1 / foot.z() - at_top;
  bool is_checked = false;
  // All images are the picture's size.
  const std::ptrdiff_t width = surfaces.label.width();
  const std::uint8_t* const mask = view.input.masks.color.data();
  for (int i = 1; i <= steps; ++i) {
    const float share = static_cast<float>(i) / static_cast<float>(steps);
    const auto& [column, row] = nearest_pixel(start + share * way);
    if (!view.part.contains(column, row)) return;
    const std::ptrdiff_t at = row * width + column;
    if (mask[at] == 0) continue;
    const float z = 1 / (at_top + share * to_foot);
    if (!view.hides_at(at, z)) continue;
    if (!is_checked && !is_solid(view, top, height_m)) return;
    is_checked = true;
    lower_to(z, surfaces.standing_depth_m.data()[at], surfaces.label.data()[at]);
  }
}

/// Marks a row's pixels of things that have something further away beside or below them. Not those
/// at the back: what is below them is hidden by what is below the front.
void StandingThings::find_edges(const View& view, int y, int begin, int end, std::uint8_t* edges) {
  // Things cover little of the picture.
  constexpr int at_once = 64;
  const std::uint8_t* const label = view.label.row(y);
  const float* const own = view.input.reconstruction.depth_m.row(y);
  const float* const below = view.input.reconstruction.depth_m.row(y + 1);
  std::fill(edges + begin, edges + end, std::uint8_t{0});
  for (int first = begin;
       (first = find_equal(label, first, end, surface_label::foreground)) < end;) {
    const int last = std::min(first + at_once, end);
    for (int x = first; x < last; ++x) {
      const float furthest = own[x] + thing_step_m;
      const bool is_beside = any_of(own[x - 1] == 0, own[x - 1] > furthest, own[x + 1] == 0,
                                    own[x + 1] > furthest, below[x] == 0, below[x] > furthest);
      edges[x] = all_of(label[x] == surface_label::foreground, is_beside) ? 1 : 0;
    }
    first = last;
  }
}

/// What lies in row y between two such pixels, or between one and the thing itself, is part of the
/// thing, too: things have no slits.
void StandingThings::close_slits(const View& view, int y, Surfaces& surfaces) {
  const int begin = view.part.x;
  const int end = view.part.right();
  std::uint8_t* const label = surfaces.label.row(y);
  const std::uint8_t* const source = view.input.reconstruction.source.row(y);
  float* const side_m = surfaces.standing_depth_m.row(y);
  const auto depth_m = [&](int x) {
    return label[x] == surface_label::standing ? side_m[x] : view.depth_m(x, y);
  };
  const auto is_thing_at = [&](int x, float z_m) {
    const bool is_seen =
        label[x] == surface_label::foreground && source[x] != provenance::remembered;
    return (is_seen || label[x] == surface_label::standing) &&
           std::abs(depth_m(x) - z_m) < slit_step_m;
  };
  // From a side's last pixel on, to the left or the right.
  const auto close = [&](int from, int step) {
    const int widest = std::min(widest_slit_px, step < 0 ? from - begin : end - 1 - from);
    const float z = side_m[from];
    int away = 1;
    while (away <= widest && !is_thing_at(from + away * step, z)) {
      if (!view.hides(from + away * step, y, z)) return;
      ++away;
    }
    if (away > widest) return;
    const int to = from + away * step;
    const float farthest = std::max(z, depth_m(to));
    for (int x = from + step; x != to; x += step) {
      if (!view.hides(x, y, farthest)) return;
    }
    for (int x = from + step; x != to; x += step) {
      label[x] = surface_label::standing;
      side_m[x] = farthest;
    }
  };
  for_each_run(label, begin, end, surface_label::standing, [&](int first, int last) {
    close(first, -1);
    close(last - 1, 1);
  });
}

/// What touches nothing of its thing would have no colour: the old labels come back.
void StandingThings::drop_loose(const View& view, const Surfaces& seen, Surfaces& surfaces) {
  regions_.begin();
  const int end = view.part.right();
  for (int y = view.part.y; y < view.part.bottom(); ++y) {
    const std::uint8_t* const label = surfaces.label.row(y);
    for_each_run(label, view.part.x, end, surface_label::standing,
                 [&](int first, int last) { regions_.add(y, first, last); });
  }
  regions_.connect(Connectivity::four);
  const auto touches = [&](int x, int y, float z_m) {
    return view.part.contains(x, y) && surfaces.label(x, y) == surface_label::foreground &&
           may_be_one_thing(view.depth_m(x, y), z_m);
  };
  is_held_.assign(regions_.regions().size(), 0);
  for (const ConnectedRegions::Run& run : regions_.runs()) {
    bool is_held = false;
    for (int x = run.first; x < run.last && !is_held; ++x) {
      const float z = surfaces.standing_depth_m(x, run.y);
      is_held = touches(x - 1, run.y, z) || touches(x + 1, run.y, z) || touches(x, run.y - 1, z) ||
                touches(x, run.y + 1, z);
    }
    is_held_[static_cast<std::size_t>(run.region)] |= is_held ? 1 : 0;
  }
  for (const ConnectedRegions::Run& run : regions_.runs()) {
    if (is_held_[static_cast<std::size_t>(run.region)] != 0) continue;
    std::copy(seen.label.row(run.y) + run.first, seen.label.row(run.y) + run.last,
              surfaces.label.row(run.y) + run.first);
  }
}

void StandingThings::find(const Input& input, const Surfaces& seen, Surfaces& surfaces) {
  const Rect& region = surfaces.region = seen.region;
  surfaces.label.resize(seen.label.width(), seen.label.height());
  for_rows(region.height, [&](Rows rows) {
    for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
      std::copy_n(seen.label.row(y) + region.x, region.width, surfaces.label.row(y) + region.x);
    }
  });
  surfaces.standing_depth_m.resize(0, 0);
  const BackgroundPlane* const plane = find_support(input.planes);
  const Rect drawn = intersect(input.reconstruction.region, surfaces.label.bounds());
  const Rect part = intersect(drawn, input.objects);
  if (plane == nullptr || part.empty()) return;
  const View view{input, *plane, seen.label, part};
  place_cameras(input);
  surfaces.standing_depth_m.resize(surfaces.label.width(), surfaces.label.height());
  surfaces.standing_depth_m.fill(view.part, 0);
  const Rect inner = intersect(view.part, grow(drawn, -1));
  edges_.resize(static_cast<std::size_t>(surfaces.label.height() / rows_together) + 1);
  for_row_groups(inner.height, rows_together, [&](Rows rows) {
    std::vector<std::uint8_t>& edges = edges_[static_cast<std::size_t>(rows.band)];
    edges.resize(static_cast<std::size_t>(surfaces.label.width()));
    for (int y = inner.y + rows.first; y < inner.y + rows.last; ++y) {
      find_edges(view, y, inner.x, inner.right(), edges.data());
      for (int x = inner.x; (x = find_equal(edges.data(), x, inner.right(), 1)) < inner.right();
           ++x) {
        if (view.is_remembered(x, y)) continue;
        const float z = view.depth_m(x, y);
        const bool hides =
            view.hides(x - 1, y, z) || view.hides(x + 1, y, z) || view.hides(x, y + 1, z);
        if (hides && is_top(view, x, y)) lower(view, x, y, surfaces);
      }
    }
  });
  for_rows(part.height, [&](Rows rows) {
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) close_slits(view, y, surfaces);
  });
  drop_loose(view, seen, surfaces);
}

}  // namespace diminish
