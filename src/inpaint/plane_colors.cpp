#include "inpaint/plane_colors.h"

#include <algorithm>

namespace diminish {

void PlaneColors::collect(const Mask& occlusion, const Surfaces& surfaces,
                          const Image<Bgr>& picture) {
  region_ = intersect(surfaces.region, surfaces.label.bounds());
  columns_ = (region_.width + cell - 1) / cell;
  rows_ = (region_.height + cell - 1) / cell;
  find_objects(occlusion);
  table_.resize(static_cast<std::size_t>(columns_ + 1) * static_cast<std::size_t>(rows_ + 1));
  const auto clear = [](Cell& entry) {
    for (Sum& sum : entry.sums) sum.setZero();
  };
  std::for_each(cell_row(0), cell_row(1), clear);
  for (int row = 0; row < rows_; ++row) {
    std::for_each(cell_row(row + 1), cell_row(row + 2), clear);
    add_row(row, surfaces.label, picture);
    const Cell* above = cell_row(row);
    Cell* own = cell_row(row + 1);
    for (int plane = 0; plane < planes; ++plane) {
      Sum so_far = Sum::Zero();
      for (int column = 1; column <= columns_; ++column) {
        so_far += own[column].sums[plane];
        own[column].sums[plane] = above[column].sums[plane] + so_far;
      }
    }
  }
}

void PlaneColors::find_objects(const Mask& occlusion) {
  has_object_.resize(columns_, rows_, 0);
  near_object_.resize(columns_, rows_, 0);
  const int columns = columns_;
  for (int y = 0; y < region_.height; y += step) {
    const std::uint8_t* mask = occlusion.row(region_.y + y) + region_.x;
    std::uint8_t* has = has_object_.row(y / cell);
    for (int x = 0; x < region_.width; x += step) has[x / cell] |= mask[x];
  }
  for (int row = 0; row < rows_; ++row) {
    const std::uint8_t* const has = has_object_.row(row);
    for (int other = std::max(row - gap, 0); other <= std::min(row + gap, rows_ - 1); ++other) {
      std::uint8_t* const near = near_object_.row(other);
      for (int shift = -gap; shift <= gap; ++shift) {
        const int end = columns - std::max(shift, 0);
        for (int column = std::max(-shift, 0); column < end; ++column) {
          near[column + shift] |= has[column];
        }
      }
    }
  }
}

/// The colours of a row of cells, each in the entry to its lower right.
void PlaneColors::add_row(int row, const Image<std::uint8_t>& labels, const Image<Bgr>& picture) {
  Cell* own = cell_row(row + 1) + 1;
  const std::uint8_t* near = near_object_.row(row);
  const int end = std::min((row + 1) * cell, region_.height);
  for (int y = row * cell; y < end; y += step) {
    const std::uint8_t* label = labels.row(region_.y + y) + region_.x;
    const Bgr* colors = picture.row(region_.y + y) + region_.x;
    for (int x = 0; x < region_.width; x += step) {
      const int plane = label[x] - surface_label::first_plane;
      if (plane < 0 || plane >= planes || near[x / cell] != 0) continue;
      own[x / cell].sums[plane] += Sum(colors[x].b, colors[x].g, colors[x].r, 1);
    }
  }
}

bool PlaneColors::around(int x, int y, std::uint8_t label, Eigen::Array3f& mean) const {
  const int plane = label - surface_label::first_plane;
  if (!region_.contains(x, y) || plane < 0 || plane >= planes) return false;
  const Rect part = intersect(grow({(x - region_.x) / cell, (y - region_.y) / cell, 1, 1}, reach),
                              {0, 0, columns_, rows_});
  const Cell* upper = cell_row(part.y);
  const Cell* lower = cell_row(part.bottom());
  // Unsigned: intermediate overflow does no harm.
  const Sum sum = lower[part.right()].sums[plane] - lower[part.x].sums[plane] -
                  upper[part.right()].sums[plane] + upper[part.x].sums[plane];
  if (sum[3] < std::uint32_t{fewest}) return false;
  const Eigen::Array4f total = sum.cast<float>();
  mean = total.head<3>() / total[3];
  return true;
}

}  // namespace diminish
