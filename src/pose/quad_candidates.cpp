#include "pose/quad_candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/shrink.h"

namespace diminish {
namespace {

/// In pixels of the small picture. The smallest marker wanted has sides of 60 / 4 = 15 pixels,
/// fewer where it is foreshortened.
constexpr int min_box = 8;
constexpr double min_side = 7;
/// A quadrilateral's share of its hull: that of a disc is 0.64, that of a hexagon 0.67.
constexpr double min_share = 0.75;

/// Twice the signed area of a triangle; positive if clockwise with y down.
long doubled_area(int ax, int ay, int bx, int by, int cx, int cy) {
  return static_cast<long>(bx - ax) * (cy - ay) - static_cast<long>(cx - ax) * (by - ay);
}

}  // namespace

const std::vector<Quad>& QuadCandidates::find(const ConnectedRegions& regions) {
  quads_.clear();
  for (const ConnectedRegions::Region& region : regions.regions()) {
    if (std::max(region.box.width, region.box.height) < min_box ||
        std::min(region.box.width, region.box.height) < min_box / 2 ||
        region.pixels < region.box.width + region.box.height) {
      continue;
    }
    find_hull(regions, region);
    Quad quad;
    if (reduce_to_quad(quad)) quads_.push_back(quad);
  }
  return quads_;
}

void QuadCandidates::find_hull(const ConnectedRegions& regions,
                               const ConnectedRegions::Region& region) {
  // The outline's ends on each line between two rows of pixels, from top to bottom: sorted.
  points_.clear();
  int above_first = std::numeric_limits<int>::max();
  int above_last = std::numeric_limits<int>::min();
  const std::vector<ConnectedRegions::Run>& runs = regions.runs();
  for (int i = region.first_run; i >= 0;) {
    const int y = runs[i].y;
    int first = std::numeric_limits<int>::max();
    int last = std::numeric_limits<int>::min();
    for (; i >= 0 && runs[i].y == y; i = runs[i].next) {
      first = std::min(first, runs[i].first);
      last = std::max(last, runs[i].last);
    }
    points_.push_back({std::min(first, above_first), y});
    points_.push_back({std::max(last, above_last), y});
    above_first = first;
    above_last = last;
  }
  points_.push_back({above_first, region.box.bottom()});
  points_.push_back({above_last, region.box.bottom()});
  // Andrew 1979, down the right side and up the left: clockwise.
  hull_.clear();
  const auto add = [this](const Point& point, std::size_t base) {
    while (hull_.size() > base + 1) {
      const Point& a = hull_[hull_.size() - 2];
      const Point& b = hull_.back();
      if (doubled_area(a.x, a.y, b.x, b.y, point.x, point.y) > 0) break;
      hull_.pop_back();
    }
    hull_.push_back(point);
  };
  for (const Point& point : points_) add(point, 0);
  const std::size_t base = hull_.size() - 1;
  for (std::size_t i = points_.size() - 1; i-- > 0;) add(points_[i], base);
  hull_.pop_back();
}

bool QuadCandidates::reduce_to_quad(Quad& quad) {
  const auto area_at = [this](std::size_t i) {
    const std::size_t n = hull_.size();
    const Point& a = hull_[(i + n - 1) % n];
    const Point& b = hull_[i];
    const Point& c = hull_[(i + 1) % n];
    return doubled_area(a.x, a.y, b.x, b.y, c.x, c.y);
  };
  const auto polygon_area = [this] {
    long sum = 0;
    for (std::size_t i = 1; i + 1 < hull_.size(); ++i) {
      sum += doubled_area(hull_[0].x, hull_[0].y, hull_[i].x, hull_[i].y, hull_[i + 1].x,
                          hull_[i + 1].y);
    }
    return sum;
  };
  if (hull_.size() < 4) return false;
  const auto hull_area = static_cast<double>(polygon_area());
  // Again and again the vertex that spans the least area goes (Visvalingam & Whyatt 1993).
  while (hull_.size() > 4) {
    std::size_t least = 0;
    for (std::size_t i = 1; i < hull_.size(); ++i) {
      if (area_at(i) < area_at(least)) least = i;
    }
    hull_.erase(hull_.begin() + static_cast<std::ptrdiff_t>(least));
  }
  if (static_cast<double>(polygon_area()) < min_share * hull_area) return false;
  for (std::size_t i = 0; i < 4; ++i) {
    const Point& a = hull_[i];
    const Point& b = hull_[(i + 1) % 4];
    if (std::hypot(b.x - a.x, b.y - a.y) < min_side) return false;
    quad[i] = {green_shrinkage * a.x - 0.5, green_shrinkage * a.y - 0.5};
  }
  return true;
}

}  // namespace diminish
