#include "reconstruct/edge_snapping.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/rows.h"
#include "reconstruct/sdct.h"

namespace diminish {
namespace {

/// How far from an edge pixels are looked at, and which their neighbours are.
constexpr int reach = 2;
/// Two surfaces: at least so far apart, and by so many times the noise.
constexpr float least_gap_m = 0.05F;
constexpr float least_gap_noise = 3;
/// Surfaces of colours closer than this are not told apart.
constexpr float least_contrast = 20;
/// What even a plain surface's colours differ by.
constexpr float usual_spread = 10;
/// Of a surface's slope, against its neighbours' number: there are few.
constexpr float slope_ridge = 1;

bool is_neighbour(int x, int y) {
  return x * x + y * y <= reach * reach;
}

float distance(const Bgr3& a, const Bgr3& b) {
  return std::hypot(a.b - b.b, a.g - b.g, a.r - b.r);
}

/// A surface's colours: their mean, and the root mean square distance from it.
struct SurfaceColors {
  Bgr3 mean;
  float spread;
};
template <class Iterator>
std::optional<SurfaceColors> colors_of(Iterator begin, Iterator end) {
  Bgr3 sum{0, 0, 0};
  float known = 0;
  for (auto n = begin; n != end; ++n) {
    if (!n->color) continue;
    sum = {sum.b + n->color->b, sum.g + n->color->g, sum.r + n->color->r};
    ++known;
  }
  if (known == 0) return std::nullopt;
  const Bgr3 mean{sum.b / known, sum.g / known, sum.r / known};
  float squares = 0;
  for (auto n = begin; n != end; ++n) {
    if (n->color) squares += distance(*n->color, mean) * distance(*n->color, mean);
  }
  return SurfaceColors{mean, std::sqrt(squares / known)};
}

/// A surface's depth at a pixel, from its neighbours there, the nearest first: along a plane 1/z is
/// linear in the image.
template <class Iterator>
float depth_of_plane(Iterator begin, Iterator end) {
  float weight_sum = 0;
  float mean = 0;
  const auto weight_of = [](const auto& n) {
    return std::exp(-static_cast<float>(n.x * n.x + n.y * n.y) / (reach * reach));
  };
  for (auto n = begin; n != end; ++n) {
    const float weight = weight_of(*n);
    weight_sum += weight;
    mean += weight / n->depth_m;
  }
  mean /= weight_sum;
  Eigen::Matrix3f normal = Eigen::Vector3f(0, slope_ridge, slope_ridge).asDiagonal();
  Eigen::Vector3f right = Eigen::Vector3f::Zero();
  for (auto n = begin; n != end; ++n) {
    const float weight = weight_of(*n);
    const Eigen::Vector3f place(1, static_cast<float>(n->x), static_cast<float>(n->y));
    normal += weight * place * place.transpose();
    right += weight * (1 / n->depth_m - mean) * place;
  }
  const float depth_m = 1 / (mean + normal.llt().solve(right)(0));
  return std::clamp(depth_m, begin->depth_m - least_gap_m, (end - 1)->depth_m + least_gap_m);
}

}  // namespace

EdgeSnapping::EdgeSnapping(const RgbdCamera& camera)
    : camera_(camera),
      rays_(Lens(camera.depth).rays()),
      to_color_(camera.color_from_depth),
      color_(Lens(camera.color)),
      unit_m_(static_cast<float>(camera.depth_unit_m)) {
  beside_edge_.resize(camera.depth.width, camera.depth.height, 0);
  is_read_.resize(camera.depth.width, camera.depth.height, 0);
  colors_.resize(camera.depth.width, camera.depth.height);
}

void EdgeSnapping::snap(const Images& images, const Rect& part, Image<std::uint16_t>& depth) {
  const Rect inner = intersect(part, grow(depth.bounds(), -reach));
  if (inner.empty()) return;
  depth_ = depth;
  find_edges(inner);
  read_colors(images, inner);
  for_rows(inner.height, [&](Rows rows) {
    for (int y = inner.y + rows.first; y < inner.y + rows.last; ++y) {
      snap_row(images, inner, y, depth);
    }
  });
}

/// By the span of depth in the square around each pixel.
void EdgeSnapping::find_edges(const Rect& part) {
  const auto gap = static_cast<std::uint16_t>(std::min(65535.F, least_gap_m / unit_m_));
  for_rows(part.height, [&](Rows rows) {
    auto& [nearest, furthest] = spans_[rows.first == 0 ? 0 : 1];
    nearest.resize(static_cast<std::size_t>(part.width + 2 * reach));
    furthest.resize(nearest.size());
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      std::fill(nearest.begin(), nearest.end(), std::uint16_t{65535});
      std::fill(furthest.begin(), furthest.end(), std::uint16_t{0});
      for (int row = y - reach; row <= y + reach; ++row) {
        const std::uint16_t* depth = depth_.row(row) + part.x - reach;
        for (std::size_t i = 0; i < nearest.size(); ++i) {
          // 0, no measurement, is the furthest for one and the nearest for the other.
          const auto measured = static_cast<std::uint16_t>(depth[i] - 1);
          nearest[i] = std::min(nearest[i], measured);
          furthest[i] = std::max(furthest[i], depth[i]);
        }
      }
      std::uint8_t* beside_edge = beside_edge_.row(y) + part.x;
      for (int i = 0; i < part.width; ++i) {
        int least = 65535;
        int most = 0;
        for (int k = i; k <= i + 2 * reach; ++k) {
          least = std::min<int>(least, nearest[static_cast<std::size_t>(k)]);
          most = std::max<int>(most, furthest[static_cast<std::size_t>(k)]);
        }
        beside_edge[i] = most - least - 1 > gap ? 1 : 0;
      }
    }
  });
}

/// The colours of the pixels beside edges and of their neighbours.
void EdgeSnapping::read_colors(const Images& images, const Rect& part) {
  const Rect around = grow(part, reach);
  for_rows(around.height, [&](Rows rows) {
    for (int y = around.y + rows.first; y < around.y + rows.last; ++y) {
      std::uint8_t* is_read = is_read_.row(y);
      std::fill(is_read + around.x, is_read + around.right(), std::uint8_t{0});
      for (int row = std::max(part.y, y - reach); row <= std::min(part.bottom() - 1, y + reach);
           ++row) {
        const std::uint8_t* beside_edge = beside_edge_.row(row);
        for (int x = part.x; x < part.right(); ++x) {
          if (beside_edge[x] == 0) continue;
          std::fill(is_read + x - reach, is_read + x + reach + 1, std::uint8_t{1});
        }
      }
      for (int x = around.x; x < around.right(); ++x) {
        if (is_read[x] == 0) continue;
        const std::uint16_t value = depth_(x, y);
        const bool is_free = value != 0 && images.depth_mask(x, y) == 0;
        const auto color =
            is_free ? color_at(images, x, y, static_cast<float>(value) * unit_m_) : std::nullopt;
        is_read[x] = color ? 1 : 0;
        if (color) colors_(x, y) = *color;
      }
    }
  });
}

/// The mean of nine pixels where a depth pixel of this depth lies in the colour image.
std::optional<Bgr3> EdgeSnapping::color_at(const Images& images, int x, int y,
                                           float depth_m) const {
  const float side = rays_(x, y).x() * depth_m;
  const float down = rays_(x, y).y() * depth_m;
  const float ahead = to_color_.apply(2, side, down, depth_m);
  float u = 0;
  float v = 0;
  if (!(ahead > sdct::near_plane_m) ||
      !color_.distort(to_color_.apply(0, side, down, depth_m) / ahead,
                      to_color_.apply(1, side, down, depth_m) / ahead, u, v)) {
    return std::nullopt;
  }
  const Image<Bgr>& image = images.color;
  if (!(u >= 1 && v >= 1 && u < static_cast<float>(image.width() - 2) &&
        v < static_cast<float>(image.height() - 2))) {
    return std::nullopt;
  }
  const auto column = static_cast<int>(std::lrint(u));
  const auto line = static_cast<int>(std::lrint(v));
  if (images.color_mask(column, line) != 0) return std::nullopt;
  int b = 0;
  int g = 0;
  int r = 0;
  for (int row = line - 1; row <= line + 1; ++row) {
    const Bgr* pixels = image.row(row) + column - 1;
    for (int i = 0; i < 3; ++i) {
      b += pixels[i].b;
      g += pixels[i].g;
      r += pixels[i].r;
    }
  }
  return Bgr3{static_cast<float>(b) / 9, static_cast<float>(g) / 9, static_cast<float>(r) / 9};
}

void EdgeSnapping::snap_row(const Images& images, const Rect& part, int y,
                            Image<std::uint16_t>& depth) const {
  Neighbours neighbours;
  for (int x = part.x; x < part.right(); ++x) {
    if (beside_edge_(x, y) == 0 || images.depth_mask(x, y) != 0) continue;
    std::size_t count = 0;
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        if (!is_neighbour(dx, dy)) continue;
        const std::uint16_t value = depth_(x + dx, y + dy);
        if (value == 0 || images.depth_mask(x + dx, y + dy) != 0) continue;
        neighbours[count++] = {dx, dy, static_cast<float>(value) * unit_m_,
                               is_read_(x + dx, y + dy) != 0 ? &colors_(x + dx, y + dy) : nullptr};
      }
    }
    const auto chosen_m = choose(images, x, y, neighbours, count);
    if (!chosen_m) continue;
    depth(x, y) =
        static_cast<std::uint16_t>(std::clamp(std::lrint(*chosen_m / unit_m_), 1L, 65535L));
  }
}

/// The pixel's depth on the surface that it belongs to; nothing if there are not two of them, or
/// they cannot be told apart.
std::optional<float> EdgeSnapping::choose(const Images& images, int x, int y,
                                          Neighbours& neighbours, std::size_t count) const {
  const auto begin = neighbours.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(count);
  std::sort(begin, end,
            [](const Neighbour& a, const Neighbour& b) { return a.depth_m < b.depth_m; });
  auto cut = begin;
  if (count > 0) {
    float gap = std::max(least_gap_m, least_gap_noise * noise_.at(begin->depth_m));
    for (auto n = begin + 1; n < end; ++n) {
      if (n->depth_m - (n - 1)->depth_m <= gap) continue;
      gap = n->depth_m - (n - 1)->depth_m;
      cut = n;
    }
  }
  if (cut == begin) return std::nullopt;

  const auto front = colors_of(begin, cut);
  const auto back = colors_of(cut, end);
  if (!front || !back || distance(front->mean, back->mean) < least_contrast) return std::nullopt;
  // The colour sensor stands beside the depth sensor: what it sees there depends on the depth.
  const float front_m = depth_of_plane(begin, cut);
  const float back_m = depth_of_plane(cut, end);
  const auto front_sight = color_at(images, x, y, front_m);
  const auto back_sight = color_at(images, x, y, back_m);
  if (!front_sight || !back_sight) return std::nullopt;
  const float front_misfit = distance(*front_sight, front->mean);
  const float back_misfit = distance(*back_sight, back->mean);
  const auto is_own = [](const Neighbour& n) { return n.x == 0 && n.y == 0; };
  if (std::any_of(begin, cut, is_own) && front_misfit < least_contrast) return front_m;
  if (std::any_of(cut, end, is_own) && back_misfit < least_contrast) return back_m;
  return front_misfit < back_misfit ? front_m : back_m;
}

}  // namespace diminish
