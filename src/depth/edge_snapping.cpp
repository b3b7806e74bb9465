#include "depth/edge_snapping.h"

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
  // The normal equations' lower half; what is known of the slopes beforehand is that they are
  // small.
  float w = 0, wx = 0, wy = 0;
  float wxx = slope_ridge, wxy = 0, wyy = slope_ridge;
  float mean = 0;
  for (auto n = begin; n != end; ++n) {
    const auto& offset = *n->offset;
    w += offset.weight;
    wx += offset.weight_x;
    wy += offset.weight_y;
    wxx += offset.weight_xx;
    wxy += offset.weight_xy;
    wyy += offset.weight_yy;
    mean += offset.weight * n->inverse_depth;
  }
  mean /= w;
  float right = 0, right_x = 0, right_y = 0;
  for (auto n = begin; n != end; ++n) {
    const float above = n->inverse_depth - mean;
    right += n->offset->weight * above;
    right_x += n->offset->weight_x * above;
    right_y += n->offset->weight_y * above;
  }
  // Cramer's rule: all that is wanted is the first unknown.
  const float of_w = wxx * wyy - wxy * wxy;
  const float of_x = wx * wyy - wxy * wy;
  const float of_y = wx * wxy - wxx * wy;
  const float determinant = w * of_w - wx * of_x + wy * of_y;
  const float own = (right * of_w - right_x * of_x + right_y * of_y) / determinant;
  const float depth_m = 1 / (mean + own);
  return std::clamp(depth_m, begin->depth_m - least_gap_m, (end - 1)->depth_m + least_gap_m);
}

/// The mean of a pixel and the eight around it.
Bgr3 mean_of_nine(ImageView<Bgr> image, int column, int line) {
  // Every other byte of eight, in 16 bits each, from the first and from the second on; and the
  // ninth.
  constexpr std::uint64_t every_other = 0x00FF00FF00FF00FF;
  std::uint64_t even = 0;
  std::uint64_t odd = 0;
  unsigned r = 0;
  for (int row = line - 1; row <= line + 1; ++row) {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(image.row(row) + column - 1);
    std::uint64_t eight = 0;
    for (int i = 0; i < 8; ++i) eight |= std::uint64_t{bytes[i]} << (8 * i);
    even += eight & every_other;
    odd += eight >> 8 & every_other;
    r += bytes[8];
  }
  const auto sum_at = [](std::uint64_t sums, int i) {
    return static_cast<unsigned>(sums >> (16 * i) & 0xFFFF);
  };
  const unsigned b = sum_at(even, 0) + sum_at(odd, 1) + sum_at(even, 3);
  const unsigned g = sum_at(odd, 0) + sum_at(even, 2) + sum_at(odd, 3);
  r += sum_at(even, 1) + sum_at(odd, 2);
  return Bgr3{static_cast<float>(b) / 9, static_cast<float>(g) / 9, static_cast<float>(r) / 9};
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
      const float weight = std::exp(-static_cast<float>(square) / (reach * reach));
      const auto u = static_cast<float>(x);
      const auto v = static_cast<float>(y);
      circle[count++] = {
          x, y, weight, weight * u, weight * v, weight * u * u, weight * u * v, weight * v * v};
    }
  }
  return circle;
}();

EdgeSnapping::EdgeSnapping(const RgbdCamera& camera)
    : rays_(RayTable::of(camera.depth)),
      places_(camera),
      unit_m_(static_cast<float>(camera.depth_unit_m)),
      gap_{least_gap_m / unit_m_, least_gap_noise * DepthNoise().constant_m / unit_m_,
           least_gap_noise * DepthNoise().by_square * unit_m_},
      is_edge_(camera.depth.width, camera.depth.height),
      beside_edge_(camera.depth.width, camera.depth.height),
      is_read_(camera.depth.width, camera.depth.height),
      colors_(camera.depth.width, camera.depth.height),
      closer_than_gap_(static_cast<std::uint16_t>(std::min(gap_.least, 65535.F))) {
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    steps_[i] = offsets[i].y * std::ptrdiff_t{camera.depth.width} + offsets[i].x;
  }
}

void EdgeSnapping::snap(const Images& images, const DepthPart& part, Image<std::uint16_t>& depth) {
  if (part.bounds().empty()) return;
  depth_.resize(depth.width(), depth.height());
  const Rect& bounds = part.bounds();
  for (int y = bounds.y; y < bounds.bottom(); ++y) {
    std::copy_n(depth.row(y) + bounds.x, bounds.width, depth_.row(y) + bounds.x);
  }
  find_edges(part, images.depth_mask);
  read_colors(images, bounds);
  for_rows(bounds.height, [&](Rows rows) {
    for (int y = bounds.y + rows.first; y < bounds.y + rows.last; ++y) {
      for_each_set(beside_edge_.row(y) + bounds.x, bounds.width,
                   [&](int i) { snap_pixel(images, bounds.x + i, y, depth); });
    }
  });
}

/// Marks the pixels around which there are two surfaces.
void EdgeSnapping::find_edges(const DepthPart& part, const Mask& mask) {
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
  free_.resize(depth_.width(), depth_.height());
  for_rows(bounds.height, [&](Rows rows) {
    for (int y = bounds.y + rows.first; y < bounds.y + rows.last; ++y) {
      depth_rows::leave_out(depth_.row(y) + bounds.x, mask.row(y) + bounds.x, bounds.width,
                            free_.row(y) + bounds.x);
    }
  });
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
      depth_rows::keep_gaps(free_.row(y) + first, free_.width(), last - first, gap_, flags + first);
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
      if (next > steps) continue;
      const int other = depth[x + next * step];
      if (std::abs(depth[x] - other) <= closer_than_gap_ || gap_.is_between(depth[x], other) == 0) {
        continue;
      }
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
    std::array<const std::uint8_t*, 2 * reach + 1> united;
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      std::size_t count = 0;
      const int last = std::min(part.bottom() - 1, y + by);
      for (int row = std::max(part.y, y - by); row <= last; ++row) {
        united[count++] = flags.row(row) + part.x;
      }
      depth_rows::unite({united.data(), count}, part.width, line.data() + margin);
      for (std::size_t k = 0; k <= 2 * margin; ++k) united[k] = line.data() + k;
      depth_rows::unite({united.data(), 2 * margin + 1}, part.width, wider.row(y) + part.x);
    }
  });
}

/// Reads the colours of the pixels that `is_read_` marks, and unmarks those that have none.
void EdgeSnapping::read_colors(const Images& images, const Rect& part) {
  for_rows(part.height, [&](Rows rows) {
    Sights& sights = sights_[rows.band];
    sights.resize(static_cast<std::size_t>(part.width));
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      std::uint8_t* const is_read = is_read_.row(y);
      const std::uint16_t* const depth = free_.row(y);
      std::size_t count = 0;
      for_each_set(is_read + part.x, part.width, [&](int i) {
        const int x = part.x + i;
        is_read[x] = 0;
        if (depth[x] == 0) return;
        sights.x[count] = x;
        sights.ray_x[count] = rays_->x(y)[x];
        sights.ray_y[count] = rays_->y(y)[x];
        sights.depth_m[count++] = static_cast<float>(depth[x]) * unit_m_;
      });
      places_.find(sights.ray_x.data(), sights.ray_y.data(), sights.depth_m.data(),
                   static_cast<int>(count), sights.columns.data(), sights.lines.data());
      for (std::size_t i = 0; i < count; ++i) {
        const ColorPlaces::Place place{sights.columns[i], sights.lines[i]};
        if (!place.exists() || images.color_mask(place.column, place.line) != 0) continue;
        is_read[sights.x[i]] = 1;
        colors_(sights.x[i], y) = mean_of_nine(images.color, place.column, place.line);
      }
    }
  });
}

/// The mean of nine pixels where a depth pixel of this depth lies in the colour image.
std::optional<Bgr3> EdgeSnapping::color_at(const Images& images, int x, int y,
                                           float depth_m) const {
  const ColorPlaces::Place place = places_.at(rays_->x(y)[x], rays_->y(y)[x], depth_m);
  if (!place.exists() || images.color_mask(place.column, place.line) != 0) return std::nullopt;
  return mean_of_nine(images.color, place.column, place.line);
}

void EdgeSnapping::snap_pixel(const Images& images, int x, int y,
                              Image<std::uint16_t>& depth) const {
  if (images.depth_mask(x, y) != 0) return;
  // Numbers of neighbours below their depths, so that they can be put in the order of these.
  constexpr int number_bits = 4;
  static_assert(offsets.size() < 1U << number_bits);
  const std::uint16_t* const own = free_.row(y) + x;
  std::array<std::uint32_t, offsets.size()> keys;
  std::size_t count = 0;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const std::uint32_t value = own[steps_[i]];
    keys[count] = value << number_bits | static_cast<std::uint32_t>(i);
    count += value != 0 ? 1 : 0;
  }
  for (std::size_t i = 1; i < count; ++i) {
    const std::uint32_t key = keys[i];
    std::size_t place = i;
    for (; place > 0 && keys[place - 1] > key; --place) keys[place] = keys[place - 1];
    keys[place] = key;
  }
  const auto depth_of = [&](std::size_t i) {
    return static_cast<float>(keys[i] >> number_bits) * unit_m_;
  };
  std::size_t cut = 0;
  if (count > 0) {
    float widest_m = std::max(least_gap_m, least_gap_noise * DepthNoise().at(depth_of(0)));
    for (std::size_t i = 1; i < count; ++i) {
      const float gap_m = depth_of(i) - depth_of(i - 1);
      if (gap_m <= widest_m) continue;
      widest_m = gap_m;
      cut = i;
    }
  }
  if (cut == 0) return;
  Neighbours neighbours;
  const std::uint8_t* const is_read = is_read_.row(y) + x;
  const Bgr3* const colors = colors_.row(y) + x;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t number = keys[i] & ((1U << number_bits) - 1);
    const std::ptrdiff_t step = steps_[number];
    const float depth_m = depth_of(i);
    neighbours[i] = {&offsets[number], depth_m, 1 / depth_m,
                     is_read[step] != 0 ? colors + step : nullptr};
  }
  const auto chosen_m = choose(images, x, y, neighbours, cut, count);
  if (!chosen_m) return;
  depth(x, y) = static_cast<std::uint16_t>(std::clamp(std::lrint(*chosen_m / unit_m_), 1L, 65535L));
}

/// The pixel's depth on the surface that it belongs to, of those before and from `cut` on; nothing
/// if they cannot be told apart.
std::optional<float> EdgeSnapping::choose(const Images& images, int x, int y,
                                          const Neighbours& neighbours, std::size_t cut,
                                          std::size_t count) const {
  const auto begin = neighbours.begin();
  const auto middle = begin + static_cast<std::ptrdiff_t>(cut);
  const auto end = begin + static_cast<std::ptrdiff_t>(count);
  const auto front = mean_color(begin, middle);
  const auto back = mean_color(middle, end);
  if (!front || !back || distance(*front, *back) < least_contrast) return std::nullopt;
  struct Sight {
    float depth_m, misfit;
  };
  // The colour sensor stands beside the depth sensor: what it sees there depends on the depth.
  const auto look = [&](auto first, auto last, const Bgr3& mean) -> std::optional<Sight> {
    const float depth_m = depth_of_plane(first, last);
    const auto color = color_at(images, x, y, depth_m);
    if (!color) return std::nullopt;
    return Sight{depth_m, distance(*color, mean)};
  };
  const auto look_front = [&] { return look(begin, middle, *front); };
  const auto look_back = [&] { return look(middle, end, *back); };
  const auto is_own = [](const Neighbour& n) { return n.offset->x == 0 && n.offset->y == 0; };
  // Most pixels stay on their surface: then nobody needs to look at the other.
  const bool is_measured = free_(x, y) != 0;
  const bool is_in_front = is_measured && std::any_of(begin, middle, is_own);
  const auto own = is_in_front ? look_front() : look_back();
  if (!own) return std::nullopt;
  if (is_measured && own->misfit < least_contrast) return own->depth_m;
  const auto other = is_in_front ? look_back() : look_front();
  if (!other) return std::nullopt;
  if (own->misfit == other->misfit) return is_in_front ? other->depth_m : own->depth_m;
  return own->misfit < other->misfit ? own->depth_m : other->depth_m;
}

}  // namespace diminish
