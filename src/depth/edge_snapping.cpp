#include "depth/edge_snapping.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/rows.h"
#include "core/runs.h"
#include "depth/depth_noise.h"
#include "depth/discontinuity.h"

namespace diminish {
namespace {

/// How far from an edge pixels are looked at, and which their neighbours are.
using depth_rows::reach;

/// Pixels without depth between two surfaces.
constexpr int longest_gap_px = 3;
/// Two surfaces: at least so far apart, and by so many times the noise.
constexpr float least_gap_m = 0.05F;
constexpr float least_gap_noise = 3;
/// Surfaces of colours closer than this are not told apart.
constexpr float least_contrast = 20;
/// Of a surface's slope, against its neighbours' number: there are few.
constexpr float slope_ridge = 1;

void add_flags(const std::uint8_t* flags, std::size_t count, std::uint8_t* sum) {
  for (std::size_t i = 0; i < count; ++i) sum[i] |= flags[i];
}

float distance(const Bgr3& a, const Bgr3& b) {
  return std::sqrt((a.b - b.b) * (a.b - b.b) + (a.g - b.g) * (a.g - b.g) +
                   (a.r - b.r) * (a.r - b.r));
}

/// The mean of the neighbours' colours, as far as they are known.
template <class Iterator>
std::optional<Bgr3> mean_color(Iterator begin, Iterator end) {
  Bgr3 sum{0, 0, 0};
  float known = 0;
  for (auto n = begin; n != end; ++n) {
    if (!n->color) continue;
    sum = {sum.b + n->color->b, sum.g + n->color->g, sum.r + n->color->r};
    ++known;
  }
  if (known == 0) return std::nullopt;
  return Bgr3{sum.b / known, sum.g / known, sum.r / known};
}

/// A surface's depth at a pixel, from its neighbours there, the nearest first: along a plane 1/z is
/// linear in the image.
template <class Iterator>
float depth_of_plane(Iterator begin, Iterator end) {
  float weight_sum = 0;
  float mean = 0;
  for (auto n = begin; n != end; ++n) {
    const float weight = n->offset->weight;
    weight_sum += weight;
    mean += weight / n->depth_m;
  }
  mean /= weight_sum;
  Eigen::Matrix3f normal = Eigen::Vector3f(0, slope_ridge, slope_ridge).asDiagonal();
  Eigen::Vector3f right = Eigen::Vector3f::Zero();
  for (auto n = begin; n != end; ++n) {
    const float weight = n->offset->weight;
    const Eigen::Vector3f place(1, static_cast<float>(n->offset->x),
                                static_cast<float>(n->offset->y));
    normal += weight * place * place.transpose();
    right += weight * (1 / n->depth_m - mean) * place;
  }
  const float depth_m = 1 / (mean + normal.llt().solve(right)(0));
  return std::clamp(depth_m, begin->depth_m - least_gap_m, (end - 1)->depth_m + least_gap_m);
}

}  // namespace

/// Of the circle of radius `reach`, by a Gaussian.
const std::array<EdgeSnapping::Offset, 13> EdgeSnapping::offsets = [] {
  std::array<Offset, 13> circle{};
  std::size_t count = 0;
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const int square = x * x + y * y;
      if (square > reach * reach) continue;
      circle[count++] = {x, y, std::exp(-static_cast<float>(square) / (reach * reach))};
    }
  }
  return circle;
}();

EdgeSnapping::EdgeSnapping(const RgbdCamera& camera)
    : rays_(RayTable::of(camera.depth)),
      to_color_(camera.color_from_depth),
      color_(Lens(camera.color)),
      unit_m_(static_cast<float>(camera.depth_unit_m)),
      gap_{least_gap_m / unit_m_, least_gap_noise * DepthNoise().constant_m / unit_m_,
           least_gap_noise * DepthNoise().by_square * unit_m_},
      is_edge_(camera.depth.width, camera.depth.height),
      beside_edge_(camera.depth.width, camera.depth.height),
      is_read_(camera.depth.width, camera.depth.height),
      colors_(camera.depth.width, camera.depth.height),
      closer_than_gap_(static_cast<std::uint16_t>(std::min(gap_.least, 65535.F))) {}

void EdgeSnapping::snap(const Images& images, const DepthPart& part, Image<std::uint16_t>& depth) {
  if (part.bounds().empty()) return;
  depth_.resize(depth.width(), depth.height());
  const Rect& bounds = part.bounds();
  std::copy(depth.row(bounds.y), depth.row(bounds.bottom() - 1) + depth.width(),
            depth_.row(bounds.y));
  find_edges(part);
  read_colors(images, bounds);
  for_rows(bounds.height, [&](Rows rows) {
    for (int y = bounds.y + rows.first; y < bounds.y + rows.last; ++y) {
      for_each_set(beside_edge_.row(y) + bounds.x, bounds.width,
                   [&](int i) { snap_pixel(images, bounds.x + i, y, depth); });
    }
  });
}

/// Marks the pixels around which there are two surfaces.
void EdgeSnapping::find_edges(const DepthPart& part) {
  const Rect& bounds = part.bounds();
  for_rows(bounds.height, [&](Rows rows) {
    for (int y = bounds.y + rows.first; y < bounds.y + rows.last; ++y) {
      std::fill_n(is_edge_.row(y) + bounds.x, bounds.width, std::uint8_t{0});
      mark_gaps(part, bounds, y, false, scratch_[rows.band]);
    }
  });
  // Columns are divided between threads as rows are.
  for_rows(bounds.width, [&](Rows columns) {
    const Rect some{bounds.x + columns.first, bounds.y, columns.last - columns.first,
                    bounds.height};
    for (int y = bounds.y; y < bounds.bottom(); ++y) {
      mark_gaps(part, some, y, true, scratch_[columns.band]);
    }
  });
  widen(is_edge_, bounds, 1, beside_edge_);
  const Rect inner{bounds.x + reach, bounds.y + reach, bounds.width - 2 * reach,
                   bounds.height - 2 * reach};
  for_rows(bounds.height, [&](Rows rows) {
    for (int y = bounds.y + rows.first; y < bounds.y + rows.last; ++y) {
      std::uint8_t* flags = beside_edge_.row(y);
      const DepthPart::Columns& columns = part.columns(y);
      const bool is_inside = y >= inner.y && y < inner.bottom();
      const int first = std::min(std::max(columns.first, inner.x), bounds.right());
      const int last = is_inside ? std::max(first, std::min(columns.last, inner.right())) : first;
      std::fill(flags + bounds.x, flags + first, std::uint8_t{0});
      std::fill(flags + last, flags + bounds.right(), std::uint8_t{0});
      depth_rows::keep_gaps(depth_.row(y) + first, depth_.width(), last - first, gap_,
                            flags + first);
    }
  });
  widen(beside_edge_, bounds, reach, is_read_);
}

/// Marks the pixels on both sides of a depth edge, and those without depth between them: from the
/// pixels of a row on, to the right or downwards.
void EdgeSnapping::mark_gaps(const DepthPart& part, const Rect& within, int y, bool downwards,
                             Scratch& scratch) {
  constexpr int piece = depth_rows::piece;
  constexpr int most_steps = longest_gap_px + 1;
  const DepthPart::Columns& columns = part.columns(y);
  const int left = std::max(within.x, columns.first);
  const int count = std::min(within.right(), columns.last) - left;
  if (count <= 0) return;
  const std::uint16_t* const depth = depth_.row(y) + left;
  std::uint8_t* const is_edge = is_edge_.row(y) + left;
  const std::ptrdiff_t step = downwards ? depth_.width() : 1;
  const int rows_below = std::min(most_steps, within.bottom() - 1 - y);
  // Most pieces are one surface.
  scratch.has_jump.assign(static_cast<std::size_t>(count / piece) + 1, 1);
  depth_rows::find_jumps(depth, downwards ? count : count - most_steps, step,
                         downwards ? rows_below : most_steps, closer_than_gap_,
                         scratch.has_jump.data());
  for (int first = 0; first < count; first += piece) {
    if (scratch.has_jump[static_cast<std::size_t>(first / piece)] == 0) continue;
    for (int x = first; x < std::min(first + piece, count); ++x) {
      if (depth[x] == 0) continue;
      const int steps = downwards ? rows_below : std::min(most_steps, count - 1 - x);
      int next = 1;
      while (next <= steps && depth[x + next * step] == 0) ++next;
      if (next > steps || gap_.is_between(depth[x], depth[x + next * step]) == 0) continue;
      for (int k = 0; k <= next; ++k) is_edge[x + k * step] = 1;
    }
  }
}

/// Marks in `wider` what is marked in `flags`, and what is up to `by` pixels beside it, in `part`.
void EdgeSnapping::widen(const Image<std::uint8_t>& flags, const Rect& part, int by,
                         Image<std::uint8_t>& wider) {
  const auto width = static_cast<std::size_t>(part.width);
  const auto margin = static_cast<std::size_t>(by);
  for_rows(part.height, [&](Rows rows) {
    std::vector<std::uint8_t>& line = scratch_[rows.band].line;
    line.assign(width + 2 * margin, 0);
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      std::fill_n(line.data() + margin, width, std::uint8_t{0});
      const int last = std::min(part.bottom() - 1, y + by);
      for (int row = std::max(part.y, y - by); row <= last; ++row) {
        add_flags(flags.row(row) + part.x, width, line.data() + margin);
      }
      std::uint8_t* result = wider.row(y) + part.x;
      std::copy_n(line.data(), width, result);
      for (std::size_t k = 1; k <= 2 * margin; ++k) add_flags(line.data() + k, width, result);
    }
  });
}

/// Reads the colours of the pixels that `is_read_` marks, and unmarks those that have none.
void EdgeSnapping::read_colors(const Images& images, const Rect& part) {
  for_rows(part.height, [&](Rows rows) {
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      for_each_set(is_read_.row(y) + part.x, part.width, [&](int i) {
        const int x = part.x + i;
        const std::uint16_t value = depth_(x, y);
        const bool is_free = value != 0 && images.depth_mask(x, y) == 0;
        const auto color =
            is_free ? color_at(images, x, y, static_cast<float>(value) * unit_m_) : std::nullopt;
        is_read_(x, y) = color ? 1 : 0;
        if (color) colors_(x, y) = *color;
      });
    }
  });
}

/// The mean of nine pixels where a depth pixel of this depth lies in the colour image.
std::optional<Bgr3> EdgeSnapping::color_at(const Images& images, int x, int y,
                                           float depth_m) const {
  const float side = rays_->x(y)[x] * depth_m;
  const float down = rays_->y(y)[x] * depth_m;
  const float ahead = to_color_.apply(2, side, down, depth_m);
  float u = 0;
  float v = 0;
  if (!(ahead > sdct::near_plane_m) ||
      !color_.distort(to_color_.apply(0, side, down, depth_m) / ahead,
                      to_color_.apply(1, side, down, depth_m) / ahead, u, v)) {
    return std::nullopt;
  }
  const ImageView<Bgr>& image = images.color;
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

void EdgeSnapping::snap_pixel(const Images& images, int x, int y,
                              Image<std::uint16_t>& depth) const {
  if (images.depth_mask(x, y) != 0) return;
  Neighbours neighbours;
  std::size_t count = 0;
  for (const Offset& offset : offsets) {
    const int column = x + offset.x;
    const int row = y + offset.y;
    const std::uint16_t value = depth_(column, row);
    if (value == 0 || images.depth_mask(column, row) != 0) continue;
    const float depth_m = static_cast<float>(value) * unit_m_;
    // In their order of depth.
    std::size_t place = count++;
    for (; place > 0 && neighbours[place - 1].depth_m > depth_m; --place) {
      neighbours[place] = neighbours[place - 1];
    }
    neighbours[place] = {&offset, depth_m,
                         is_read_(column, row) != 0 ? &colors_(column, row) : nullptr};
  }
  const auto chosen_m = choose(images, x, y, neighbours, count);
  if (!chosen_m) return;
  depth(x, y) = static_cast<std::uint16_t>(std::clamp(std::lrint(*chosen_m / unit_m_), 1L, 65535L));
}

/// The pixel's depth on the surface that it belongs to; nothing if there are not two of them, or
/// they cannot be told apart.
std::optional<float> EdgeSnapping::choose(const Images& images, int x, int y,
                                          const Neighbours& neighbours, std::size_t count) const {
  const auto begin = neighbours.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(count);
  auto cut = begin;
  if (count > 0) {
    float widest_m = std::max(least_gap_m, least_gap_noise * DepthNoise().at(begin->depth_m));
    for (auto n = begin + 1; n < end; ++n) {
      const float gap_m = n->depth_m - (n - 1)->depth_m;
      if (gap_m <= widest_m) continue;
      widest_m = gap_m;
      cut = n;
    }
  }
  if (cut == begin) return std::nullopt;

  const auto front = mean_color(begin, cut);
  const auto back = mean_color(cut, end);
  if (!front || !back || distance(*front, *back) < least_contrast) return std::nullopt;
  // The colour sensor stands beside the depth sensor: what it sees there depends on the depth.
  const float front_m = depth_of_plane(begin, cut);
  const float back_m = depth_of_plane(cut, end);
  const auto front_sight = color_at(images, x, y, front_m);
  const auto back_sight = color_at(images, x, y, back_m);
  if (!front_sight || !back_sight) return std::nullopt;
  const float front_misfit = distance(*front_sight, *front);
  const float back_misfit = distance(*back_sight, *back);
  const auto is_own = [](const Neighbour& n) { return n.offset->x == 0 && n.offset->y == 0; };
  if (std::any_of(begin, cut, is_own) && front_misfit < least_contrast) return front_m;
  if (std::any_of(cut, end, is_own) && back_misfit < least_contrast) return back_m;
  return front_misfit < back_misfit ? front_m : back_m;
}

}  // namespace diminish
