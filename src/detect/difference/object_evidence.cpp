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
/// Relative distance of two layers from which on they are two surfaces.
constexpr float two_surfaces = 0.03F;

/// Between colours of the same surface, in levels.
constexpr float least_threshold = 18;
constexpr float greatest_threshold = 48;

/// Values of `kind_`.
constexpr std::uint8_t nothing = 0;      ///< no RGB-D camera sees anything
constexpr std::uint8_t on_plane = 1;     ///< the nearest surface is a wall or a table
constexpr std::uint8_t stands = 2;       ///< it is not
constexpr std::uint8_t stands_free = 3;  ///< and it stands free
constexpr std::uint8_t visited = 4;

/// A value of `object_`, beside 0 and 255.
constexpr std::uint8_t in_free_space = 254;

/// How far a colour is from all of a neighbourhood's.
float difference(const Bgr& color, const Bgr& least, const Bgr& greatest) {
  const auto beyond = [](std::uint8_t value, std::uint8_t from, std::uint8_t to) {
    const int d = std::max({0, from - value, value - to});
    return d * d;
  };
  return std::sqrt(static_cast<float>(beyond(color.b, least.b, greatest.b) +
                                      beyond(color.g, least.g, greatest.g) +
                                      beyond(color.r, least.r, greatest.r)));
}

/// How far a colour is from all shades of another.
float chroma_difference(const Bgr& color, const Bgr& other) {
  const Eigen::Array3f a = to_channels(color);
  const Eigen::Array3f b = to_channels(other);
  const float shade = (a * b).sum() / std::max(1.F, b.square().sum());
  return std::sqrt((a - std::min(shade, 1.F) * b).square().sum());
}

float gap(const SeenSurface& nearest, const SeenSurface& farthest) {
  return 1 - nearest.depth_m / farthest.depth_m;
}

}  // namespace

ObjectEvidence::ObjectEvidence(const Intrinsics& color, int shrinkage)
    : rays_(RayTable::of(shrunk_camera(color, shrinkage))) {}

bool ObjectEvidence::is_on_plane(const std::vector<BackgroundPlane>& planes, int x, int y,
                                 float depth_m) const {
  const Eigen::Vector3f point = depth_m * (*rays_)(x, y).homogeneous();
  return std::any_of(planes.begin(), planes.end(), [&](const BackgroundPlane& plane) {
    return std::abs(plane.height_m(point)) <= BackgroundPlanes::tolerance.at(depth_m);
  });
}

bool ObjectEvidence::looks_like(const Bgr& color, int x, int y) const {
  return difference(color, least_(x, y), greatest_(x, y)) < 0.25F * threshold_;
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
      if (kind_(x, y) != stands_free) continue;
      collect(layers, x, y);
      Component all;
      for (const Eigen::Vector2i& at : component_) {
        const SeenSurface& nearest = layers.nearest(at.x(), at.y());
        const SeenSurface& farthest = layers.farthest(at.x(), at.y());
        const Difference& d = difference_(at.x(), at.y());
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
        const Difference& d = difference_(x, y);
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
      for (int x = 0; x < picture.width(); ++x) {
        const SeenSurface& nearest = inputs.layers.nearest(x, y);
        const SeenSurface& farthest = inputs.layers.farthest(x, y);
        Difference& d = difference_(x, y);
        d = {};
        if (nearest.source == 0) continue;
        const bool is_one = gap(nearest, farthest) < two_surfaces;
        d.nearest = difference(nearest.color, least_(x, y), greatest_(x, y));
        d.farthest = is_one ? d.nearest : difference(farthest.color, least_(x, y), greatest_(x, y));
        d.either = std::min(d.nearest, d.farthest);
        if (d.either < least_threshold) continue;
        d.either = difference(nearest.color, least_around_(x, y), greatest_around_(x, y));
        if (is_one) continue;
        d.either = std::min(
            d.either, difference(farthest.color, least_around_(x, y), greatest_around_(x, y)));
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
        const Difference& d = difference_(x, y);
        unexplained_(x, y) = 0;
        kind_(x, y) = nothing;
        if (nearest.source == 0) continue;
        if (d.either > threshold) unexplained_(x, y) = 255;
        if (is_on_plane(inputs.planes, x, y, nearest.depth_m)) {
          kind_(x, y) = on_plane;
        } else if (gap(nearest, inputs.layers.farthest(x, y)) > inputs.clearance &&
                   d.farthest > threshold && d.nearest < d.farthest) {
          kind_(x, y) = stands_free;
        } else {
          kind_(x, y) = stands;
        }
      }
    }
  });
  open(unexplained_, 3);
}

/// The surface that a pixel belongs to, down to the planes.
void ObjectEvidence::collect(const SeenLayers& layers, int x, int y) {
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
      if (kind_(column, row) != stands && kind_(column, row) != stands_free) continue;
      const float other = layers.nearest(column, row).depth_m;
      if (std::abs(other - own) <= largest_step * own) visit(column, row);
    }
  }
}

void ObjectEvidence::open(Mask& mask, int reach) {
  erode(mask, {reach, reach}, first_, second_);
  dilate(second_, {reach, reach}, first_, mask);
}

}  // namespace diminish
