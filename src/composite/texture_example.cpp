#include "composite/texture_example.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/channels.h"
#include "core/quick_brightness.h"
#include "core/robust.h"
#include "core/rows.h"

namespace diminish {
namespace {

/// The grain of a pixel looks this far around.
constexpr int grain_reach = TextureExample::mean_reach;
/// Of a cell, every fourth pixel of every fourth row tells its colour and contrast.
constexpr int sample_step = 4;
/// Around a cell, in cells, nothing but the plane may be.
constexpr int clearance = 1;
/// Fewer cells have no typical contrast.
constexpr std::size_t fewest_for_median = 4;
constexpr int cell_rows_at_once = 4;

}  // namespace

void TextureExample::find(ImageView<Bgr> camera, const Mask& occlusion, const Rect& part,
                          const std::vector<SceneSample>& samples, const BackgroundPlane& plane) {
  // Whole cells, around which there are pixels for a mean.
  const Rect inner = intersect(part, grow(camera.bounds(), -grain_reach));
  first_column_ = (inner.x + cell - 1) / cell;
  first_row_ = (inner.y + cell - 1) / cell;
  const int columns = std::max(0, inner.right() / cell - first_column_);
  const int rows = std::max(0, inner.bottom() / cell - first_row_);
  cells_.resize(columns, rows);
  cells_.fill(cells_.bounds(), Cell{});
  grain_.resize(columns * cell, rows * cell);
  grain_.fill(grain_.bounds(), 0);
  if (cells_.empty()) return;
  mark_samples(samples, plane);
  mark_objects(occlusion);
  choose(camera);
}

void TextureExample::mark_samples(const std::vector<SceneSample>& samples,
                                  const BackgroundPlane& plane) {
  for (const SceneSample& sample : samples) {
    const auto x = static_cast<int>(std::lrint(sample.pixel.x()));
    const auto y = static_cast<int>(std::lrint(sample.pixel.y()));
    if (!part().contains(x, y)) continue;
    Cell& marked = at(x, y);
    (BackgroundPlanes::lies_on(plane, sample.point_m) ? marked.on_plane : marked.off_plane) = true;
  }
}

void TextureExample::mark_objects(const Mask& occlusion) {
  for (int row = 0; row < cells_.height(); ++row) {
    for (int y = (first_row_ + row) * cell; y < (first_row_ + row + 1) * cell; y += sample_step) {
      const std::uint8_t* mask = &occlusion(first_column_ * cell, y);
      for (int column = 0; column < cells_.width(); ++column, mask += cell) {
        int set = 0;
        for (std::ptrdiff_t x = 0; x < cell; x += sample_step) set |= mask[x];
        cells_(column, row).has_object |= set != 0;
      }
    }
  }
}

/// The cell's mean colour and its contrast: how much its brightness bends, whatever its slope.
void TextureExample::look_at(ImageView<Bgr> camera, int column, int row) {
  constexpr int lag = grain_reach - 1;
  Cell& seen = cells_(column, row);
  int squares = 0;
  const int left = (first_column_ + column) * cell;
  for (int y = sample_step / 2; y < cell; y += sample_step) {
    const int picture_y = (first_row_ + row) * cell + y;
    const Bgr* const colors = camera.row(picture_y) + left;
    const Bgr* const above = camera.row(picture_y - lag) + left;
    const Bgr* const below = camera.row(picture_y + lag) + left;
    for (int x = sample_step / 2; x < cell; x += sample_step) {
      const int twice = 2 * quick_brightness(colors[x]);
      const int across =
          twice - quick_brightness(colors[x - lag]) - quick_brightness(colors[x + lag]);
      const int down = twice - quick_brightness(above[x]) - quick_brightness(below[x]);
      squares += across * across + down * down;
      seen.mean += to_channels(colors[x]);
    }
  }
  constexpr int looked_at = (cell / sample_step) * (cell / sample_step);
  seen.mean /= static_cast<float>(looked_at);
  seen.contrast = std::sqrt(static_cast<float>(squares));
}

void TextureExample::choose(ImageView<Bgr> camera) {
  contrasts_.clear();
  for (int row = 0; row < cells_.height(); ++row) {
    for (int column = 0; column < cells_.width(); ++column) {
      bool is_plane = false;
      bool is_clear = true;
      const Rect around = intersect(grow({column, row, 1, 1}, clearance), cells_.bounds());
      for (int y = around.y; y < around.bottom(); ++y) {
        for (int x = around.x; x < around.right(); ++x) {
          const Cell& other = cells_(x, y);
          is_plane = is_plane || other.on_plane;
          is_clear = is_clear && !other.off_plane && !other.has_object;
        }
      }
      if (!is_plane || !is_clear) continue;
      look_at(camera, column, row);
      cells_(column, row).is_example = true;
      contrasts_.push_back(cells_(column, row).contrast);
    }
  }
  const bool has_median = contrasts_.size() >= fewest_for_median;
  const float most = has_median ? most_contrast * median(contrasts_) : -1;
  for (Cell& chosen : cells_) chosen.is_example = chosen.is_example && chosen.contrast <= most;
}

void TextureExample::want_grain(const Rect& touched) {
  const Rect inside = intersect(touched, part());
  if (inside.empty()) return;
  for (int row = inside.y / cell; row <= (inside.bottom() - 1) / cell; ++row) {
    for (int column = inside.x / cell; column <= (inside.right() - 1) / cell; ++column) {
      Cell& wanted = cells_(column - first_column_, row - first_row_);
      wanted.needs_grain = wanted.is_example;
    }
  }
}

void TextureExample::find_grain(ImageView<Bgr> camera) {
  for_row_groups(cells_.height(), cell_rows_at_once, [&](Rows rows) {
    for (int row = rows.first; row < rows.last; ++row) {
      for (int column = 0; column < cells_.width(); ++column) {
        if (cells_(column, row).needs_grain) find_grain(camera, column, row);
      }
    }
  });
}

void TextureExample::find_grain(ImageView<Bgr> camera, int column, int row) {
  constexpr std::size_t size = cell + 2 * grain_reach;
  constexpr std::size_t side = 2 * mean_reach + 1;
  // Twice the brightness, so that all sums fit into 16 bits.
  std::array<std::array<std::uint16_t, size>, size> bright;
  for (std::size_t y = 0; y < size; ++y) {
    const Bgr* const colors =
        &camera((first_column_ + column) * cell - grain_reach,
                (first_row_ + row) * cell + static_cast<int>(y) - grain_reach);
    for (std::size_t x = 0; x < size; ++x) {
      bright[y][x] = static_cast<std::uint16_t>(quick_brightness(colors[x]) / 2);
    }
  }
  // Of a row of pixels: sums of the 9 above and below, and 1 2 1 of 3.
  std::array<std::uint16_t, size> column_sums{};
  std::array<std::uint16_t, size> fine{};
  for (std::size_t y = 0; y + 1 < side; ++y) {
    for (std::size_t x = 0; x < size; ++x) column_sums[x] += bright[y][x];
  }
  for (std::size_t y = 0; y < cell; ++y) {
    const std::size_t middle = y + grain_reach;
    for (std::size_t x = 0; x < size; ++x) {
      column_sums[x] += bright[y + side - 1][x];
      fine[x] = static_cast<std::uint16_t>(bright[middle - 1][x] + 2 * bright[middle][x] +
                                           bright[middle + 1][x]);
    }
    std::array<std::uint16_t, cell> sums{};
    for (std::size_t k = 0; k < side; ++k) {
      for (std::size_t x = 0; x < cell; ++x) sums[x] += column_sums[x + k];
    }
    std::int16_t* const grain = &grain_(column * cell, row * cell + static_cast<int>(y));
    for (std::size_t x = 0; x < cell; ++x) {
      const std::size_t at = x + grain_reach;
      const int own = fine[at - 1] + 2 * fine[at] + fine[at + 1];
      // Of twice the brightness, own has 16, sum one for each pixel.
      constexpr int pixels = side * side;
      grain[x] = static_cast<std::int16_t>((own * pixels - 16 * sums[x]) * unit / (32 * pixels));
    }
    for (std::size_t x = 0; x < size; ++x) column_sums[x] -= bright[y][x];
  }
}

}  // namespace diminish
