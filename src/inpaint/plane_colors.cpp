#include "inpaint/plane_colors.h"

#include <algorithm>

#include "core/runs.h"

namespace diminish {

void PlaneColors::collect(const Mask& occlusion, const Surfaces& surfaces,
                          const Image<Bgr>& picture) {
  region_ = intersect(surfaces.region, surfaces.label.bounds());
  columns_ = (region_.width + cell - 1) / cell;
  rows_ = (region_.height + cell - 1) / cell;
  find_objects(occlusion);
  for (Table& table : tables_) table.is_used = false;
  for (int row = 0; row < rows_; ++row) add_row(row, surfaces.label, picture);
  for (Table& table : tables_) {
    if (!table.is_used) continue;
    for (int row = 0; row < rows_; ++row) {
      const Sum* const above = table.sums.row(row);
      Sum* const own = table.sums.row(row + 1);
      Sum so_far = Sum::Zero();
      for (int column = 1; column <= columns_; ++column) {
        so_far += own[column];
        own[column] = above[column] + so_far;
      }
    }
  }
}

void PlaneColors::find_objects(const Mask& occlusion) {
  has_object_.resize(columns_, rows_, 0);
  near_object_.resize(columns_, rows_, 0);
  const int columns = columns_;
  const int whole_cells = region_.width / cell;
  for (int y = 0; y < region_.height; y += step) {
    const std::uint8_t* mask = occlusion.row(region_.y + y) + region_.x;
    std::uint8_t* has = has_object_.row(y / cell);
    static_assert(cell == 2 * step);
    for (int column = 0; column < whole_cells; ++column, mask += cell) {
      has[column] |= mask[0] | mask[step];
    }
    for (int x = whole_cells * cell; x < region_.width; x += step, mask += step) {
      has[whole_cells] |= mask[0];
    }
  }
  // First along columns, then along rows.
  const auto add = [columns](const std::uint8_t* from, std::uint8_t* to) {
    for (int column = 0; column < columns; ++column) to[column] |= from[column];
  };
  near_column_.resize(columns, 1);
  for (int row = 0; row < rows_; ++row) {
    std::uint8_t* const near_column = near_column_.row(0);
    std::fill_n(near_column, columns, std::uint8_t{0});
    for (int other = std::max(row - gap, 0); other <= std::min(row + gap, rows_ - 1); ++other) {
      add(has_object_.row(other), near_column);
    }
    std::uint8_t* const near = near_object_.row(row);
    for (int shift = -gap; shift <= gap; ++shift) {
      const int end = columns - std::max(shift, 0);
      for (int column = std::max(-shift, 0); column < end; ++column) {
        near[column + shift] |= near_column[column];
      }
    }
  }
}

/// The colours of a row of cells, each in the entry to its lower right.
void PlaneColors::add_row(int row, const Image<std::uint8_t>& labels, const Image<Bgr>& picture) {
  for_each_run(near_object_.row(row), 0, columns_, Pixels::clear,
               [&](int first, int last) { add_cells(row, first, last, labels, picture); });
}

/// Of columns [first, last).
void PlaneColors::add_cells(int row, int first, int last, const Image<std::uint8_t>& labels,
                            const Image<Bgr>& picture) {
  const int end = std::min((row + 1) * cell, region_.height);
  for (int y = row * cell; y < end; y += step) {
    const std::uint8_t* label = labels.row(region_.y + y) + region_.x;
    const Bgr* colors = picture.row(region_.y + y) + region_.x;
    for (int x = first * cell; x < std::min(last * cell, region_.width); x += step) {
      const int plane = label[x] - surface_label::first_plane;
      if (plane < 0 || plane >= planes) continue;
      Table& table = tables_[static_cast<std::size_t>(plane)];
      if (!table.is_used) {
        table.is_used = true;
        table.sums.resize(columns_ + 1, rows_ + 1, Sum::Zero());
      }
      table.sums(x / cell + 1, row + 1) += Sum(colors[x].b, colors[x].g, colors[x].r, 1);
    }
  }
}

bool PlaneColors::around(int x, int y, std::uint8_t label, Eigen::Array3f& mean) const {
  const int plane = label - surface_label::first_plane;
  if (!region_.contains(x, y) || plane < 0 || plane >= planes) return false;
  const Rect part = intersect(grow({(x - region_.x) / cell, (y - region_.y) / cell, 1, 1}, reach),
                              {0, 0, columns_, rows_});
  const Table& table = tables_[static_cast<std::size_t>(plane)];
  if (!table.is_used) return false;
  const Sum* const upper = table.sums.row(part.y);
  const Sum* const lower = table.sums.row(part.bottom());
  // Unsigned: intermediate overflow does no harm.
  const Sum sum = lower[part.right()] - lower[part.x] - upper[part.right()] + upper[part.x];
  if (sum[3] < std::uint32_t{fewest}) return false;
  const Eigen::Array4f total = sum.cast<float>();
  mean = total.head<3>() / total[3];
  return true;
}

}  // namespace diminish
