#include "detect/difference/object_evidence.h"

#include <algorithm>
#include <cmath>

#include "core/channels.h"
#include "core/extremum_filters.h"
#include "core/rows.h"
#include "geometry/shrunk_camera.h"

namespace diminish {
namespace {

/// Neighbouring pixels of one surface: the largest relative step in depth.
constexpr float largest_step = 0.03F;

/// Between colours of the same surface, in levels.
constexpr float least_threshold = 18;
constexpr float greatest_threshold = 48;

/// Values of `kind_`.
constexpr std::uint8_t nothing = 0;       ///< no RGB-D camera sees anything
constexpr std::uint8_t something = 1;     ///< whether it is a wall or a table is not asked yet
constexpr std::uint8_t free_if_none = 2;  ///< if it is none it stands free
constexpr std::uint8_t on_plane = 3;      ///< it is a wall or a table
constexpr std::uint8_t visited = 4;

/// A value of `object_`, beside 0 and 255.
constexpr std::uint8_t in_free_space = 254;

/// How far a colour is from all shades of another.
float chroma_difference(const Bgr& color, const Bgr& other) {
  const Eigen::Array3f a = to_channels(color);
  const Eigen::Array3f b = to_channels(other);
  const float shade = (a * b).sum() / std::max(1.F, b.square().sum());
  return std::sqrt((a - std::min(shade, 1.F) * b).square().sum());
}

}  // namespace

ObjectEvidence::ObjectEvidence(const Intrinsics& color, int shrinkage)
    : rays_(RayTable::of(shrunk_camera(color, shrinkage))) {}

bool ObjectEvidence::is_on_plane(const std::vector<BackgroundPlane>& planes, int x, int y,
                                 float depth_m) const {
  const Eigen::Vector3f point = depth_m * (*rays_)(x, y).homogeneous();
  return std::any_of(planes.begin(), planes.end(), [&](const BackgroundPlane& plane) {
    return BackgroundPlanes::lies_on(plane, point);
  });
}

bool ObjectEvidence::looks_like(const Bgr& color, int x, int y) const {
  return color_difference(color, least_(x, y), greatest_(x, y)) < 0.25F * threshold_;
}

Rect ObjectEvidence::find(const Inputs& inputs, Image<Shown>& shown) {
  const SeenLayers& layers = inputs.layers;
  const int width = inputs.picture.width();
  const int height = inputs.picture.height();
  compare(inputs);
  const float threshold = find_threshold(layers);
  threshold_ = threshold;
  mark(inputs, threshold);

  object_.resize(width, height, 0);
  const int fewest = std::max(4, width * height / 2500);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (kind_(x, y) != free_if_none || lies_on_plane(inputs, x, y)) continue;
      collect(inputs, x, y);
      Component all;
      for (const Eigen::Vector2i& at : component_) {
        const SeenSurface& nearest = layers.nearest(at.x(), at.y());
        const SeenSurface& farthest = layers.farthest(at.x(), at.y());
        const SurfaceDifference& d = difference_(at.x(), at.y());
        const float apart = gap(nearest, farthest);
        ++all.pixels;
        if (apart < two_surfaces) continue;
        ++all.compared;
        if (d.nearest < d.farthest) ++all.like_nearest;
        if (apart > inputs.clearance && d.farthest > threshold) ++all.free;
      }
      const bool is_object = all.free >= fewest && 10 * all.free >= all.pixels &&
                             10 * all.like_nearest >= 6 * all.compared;
      // The picture shows what is behind it: it is elsewhere by now, and proves nothing.
      const bool is_elsewhere = 10 * all.like_nearest < 4 * all.compared;
      for (const Eigen::Vector2i& at : component_) {
        if (is_object) object_(at.x(), at.y()) = 255;
        if (is_elsewhere) unexplained_(at.x(), at.y()) = 0;
      }
    }
  }
  // What looks like nothing that is seen there
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (unexplained_(x, y) == 0) continue;
      const SeenSurface& farthest = layers.farthest(x, y);
      if (!inputs.free_space.is_free((*rays_)(x, y), (1 - inputs.clearance) * farthest.depth_m,
                                     farthest.depth_m)) {
        unexplained_(x, y) = 0;
      }
    }
  }
  return decide(inputs, threshold, shown);
}

/// What is certain, from the object's pixels and from what is unexplained.
Rect ObjectEvidence::decide(const Inputs& inputs, float threshold, Image<Shown>& shown) {
  const int width = inputs.picture.width();
  const int height = inputs.picture.height();
  scene_.resize(width, height);
  for_rows(height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < width; ++x) {
        const SeenSurface& nearest = inputs.layers.nearest(x, y);
        std::uint8_t& object = object_(x, y);
        const SurfaceDifference& d = difference_(x, y);
        const bool is_free = unexplained_(x, y) != 0;
        scene_(x, y) = 0;
        if (nearest.source == 0) continue;
        const bool like_scene = std::min(d.nearest, d.farthest) < threshold;
        if (object == 0 && !is_free && like_scene) scene_(x, y) = 255;
        if (object != 0 && gap(nearest, inputs.layers.farthest(x, y)) > two_surfaces &&
            d.farthest < 0.5F * threshold && d.farthest < d.nearest) {
          object = 0;
        }
        if (is_free) object = in_free_space;
      }
    }
  });
  open(object_, 1);
  erode(scene_, {1, 1}, first_, second_);
  const Rect near_objects =
      intersect(grow(bounding_box(object_), guessed_px), inputs.picture.bounds());
  shown.resize(width, height);
  for_rows(height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < width; ++x) {
        shown(x, y) = object_(x, y) == 255                   ? Shown::object
                      : object_(x, y) != 0                   ? Shown::unseen_object
                      : second_(x, y) != 0                   ? Shown::scene
                      : difference_(x, y).either > threshold ? Shown::unlike
                                                             : Shown::unknown;
        if (shown(x, y) == Shown::unknown && near_objects.contains(x, y) &&
            is_unlike_around(inputs, x, y, threshold)) {
          shown(x, y) = Shown::unlike;
        }
      }
    }
  });
  return near_objects;
}

/// Whether no RGB-D camera sees anything in a pixel, and it is quite unlike what they see on its
/// left and right, above and below.
bool ObjectEvidence::is_unlike_around(const Inputs& inputs, int x, int y, float threshold) const {
  if (inputs.layers.nearest(x, y).source != 0) return false;
  constexpr int reach = 16;
  constexpr float quite = 2;
  bool any = false;
  for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    for (int i = 1; i <= reach; ++i) {
      const int column = x + i * dx;
      const int row = y + i * dy;
      if (!kind_.bounds().contains(column, row)) break;
      const SeenSurface& seen = inputs.layers.farthest(column, row);
      if (seen.source == 0) continue;
      if (object_(column, row) != 0) break;
      if (chroma_difference(inputs.picture(x, y), seen.color) < quite * threshold) return false;
      any = true;
      break;
    }
  }
  return any;
}

void ObjectEvidence::compare(const Inputs& inputs) {
  const Image<Bgr>& picture = inputs.picture;
  erode(picture, {1, 1}, scratch_, least_);
  dilate(picture, {1, 1}, scratch_, greatest_);
  erode(picture, {2, 2}, scratch_, least_around_);
  dilate(picture, {2, 2}, scratch_, greatest_around_);
  difference_.resize(picture.width(), picture.height());
  for_rows(picture.height(), [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const SeenSurface* const nearest = inputs.layers.nearest.row(y);
      const SeenSurface* const farthest = inputs.layers.farthest.row(y);
      SurfaceDifference* const differences = difference_.row(y);
      compare_surfaces(nearest, farthest, least_.row(y), greatest_.row(y), picture.width(),
                       differences);
      // What is unlike is looked for further around.
      for (int x = 0; x < picture.width(); ++x) {
        SurfaceDifference& d = differences[x];
        if (d.either < least_threshold) continue;
        const auto around = [&](const SeenSurface& surface) {
          return color_difference(surface.color, least_around_(x, y), greatest_around_(x, y));
        };
        d.either = around(nearest[x]);
        if (gap(nearest[x], farthest[x]) < two_surfaces) continue;
        d.either = std::min(d.either, around(farthest[x]));
      }
    }
  });
}

/// From what single surfaces differ by, most of which are in the picture as they are.
float ObjectEvidence::find_threshold(const SeenLayers& layers) {
  values_.clear();
  constexpr int step = 3;
  for (int y = 0; y < difference_.height(); y += step) {
    for (int x = 0; x < difference_.width(); x += step) {
      const SeenSurface& nearest = layers.nearest(x, y);
      if (nearest.source == 0 || gap(nearest, layers.farthest(x, y)) > two_surfaces) continue;
      values_.push_back(difference_(x, y).nearest);
    }
  }
  if (values_.empty()) return least_threshold;
  // An object may cover most of what the RGB-D cameras see: a quarter of it is in view.
  const auto quarter = values_.begin() + static_cast<std::ptrdiff_t>(values_.size() / 4);
  std::nth_element(values_.begin(), quarter, values_.end());
  return std::clamp(8 * *quarter, least_threshold, greatest_threshold);
}

void ObjectEvidence::mark(const Inputs& inputs, float threshold) {
  const int width = inputs.picture.width();
  const int height = inputs.picture.height();
  kind_.resize(width, height);
  unexplained_.resize(width, height);
  for_rows(height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < width; ++x) {
        const SeenSurface& nearest = inputs.layers.nearest(x, y);
        const SurfaceDifference& d = difference_(x, y);
        unexplained_(x, y) = 0;
        kind_(x, y) = nothing;
        if (nearest.source == 0) continue;
        if (d.either > threshold) unexplained_(x, y) = 255;
        kind_(x, y) = gap(nearest, inputs.layers.farthest(x, y)) > inputs.clearance &&
                              d.farthest > threshold && d.nearest < d.farthest
                          ? free_if_none
                          : something;
      }
    }
  });
  open(unexplained_, 3);
}

/// Whether the nearest surface is a wall or a table; remembers it.
bool ObjectEvidence::lies_on_plane(const Inputs& inputs, int x, int y) {
  const bool lies = is_on_plane(inputs.planes, x, y, inputs.layers.nearest(x, y).depth_m);
  if (lies) kind_(x, y) = on_plane;
  return lies;
}

/// The surface that a pixel belongs to, down to the planes.
void ObjectEvidence::collect(const Inputs& inputs, int x, int y) {
  const SeenLayers& layers = inputs.layers;
  component_.clear();
  open_ends_.clear();
  const auto visit = [&](int column, int row) {
    kind_(column, row) = visited;
    component_.emplace_back(column, row);
    open_ends_.emplace_back(column, row);
  };
  visit(x, y);
  while (!open_ends_.empty()) {
    const Eigen::Vector2i at = open_ends_.back();
    open_ends_.pop_back();
    const float own = layers.nearest(at.x(), at.y()).depth_m;
    for (const auto& [dx, dy] :
         {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-2, 0}, {2, 0}, {0, -2}, {0, 2}}) {
      const int column = at.x() + dx;
      const int row = at.y() + dy;
      if (!kind_.bounds().contains(column, row)) continue;
      if (kind_(column, row) != something && kind_(column, row) != free_if_none) continue;
      const float other = layers.nearest(column, row).depth_m;
      if (std::abs(other - own) > largest_step * own || lies_on_plane(inputs, column, row))
        continue;
      visit(column, row);
    }
  }
}

void ObjectEvidence::open(Mask& mask, int reach) {
  erode(mask, {reach, reach}, first_, second_);
  dilate(second_, {reach, reach}, first_, mask);
}

}  // namespace diminish
