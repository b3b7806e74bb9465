#include "composite/plane_colors.h"

#include <algorithm>

namespace diminish {

void PlaneColors::collect(const Mask& occlusion, const Reconstruction& reconstruction,
                          const Image<Bgr>& picture) {
  region_ = intersect(reconstruction.region, reconstruction.surface.bounds());
  columns_ = (region_.width + cell - 1) / cell;
  rows_ = (region_.height + cell - 1) / cell;
  cells_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), {});
  for (int y = region_.y; y < region_.bottom(); ++y) {
    Cell* row = cells_.data() + static_cast<std::ptrdiff_t>((y - region_.y) / cell) * columns_;
    const std::uint8_t* mask = occlusion.row(y);
    const std::uint8_t* surface = reconstruction.surface.row(y);
    const Bgr* colors = picture.row(y);
    for (int column = 0; column < columns_; ++column) {
      const int first = region_.x + column * cell;
      const int last = std::min(first + cell, region_.right());
      Cell& own = row[column];
      for (int x = first; x < last; ++x) own.has_object = own.has_object || mask[x] != 0;
      if (own.has_object) continue;
      for (int x = first; x < last; ++x) {
        const int label = surface[x] - surface_label::first_plane;
        if (label < 0 || label >= planes) continue;
        Sum& sum = own.sums[label];
        sum.blue += colors[x].b;
        sum.green += colors[x].g;
        sum.red += colors[x].r;
        ++sum.count;
      }
    }
  }
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      if (near_object(column, row)) {
        std::fill(std::begin(cell_at(column, row).sums), std::end(cell_at(column, row).sums),
                  Sum{});
      }
    }
  }
}

bool PlaneColors::near_object(int column, int row) const {
  for (int r = std::max(0, row - gap); r <= std::min(rows_ - 1, row + gap); ++r) {
    for (int c = std::max(0, column - gap); c <= std::min(columns_ - 1, column + gap); ++c) {
      if (cell_at(c, r).has_object) return true;
    }
  }
  return false;
}

bool PlaneColors::around(int x, int y, std::uint8_t label, Eigen::Array3f& mean) const {
  const int plane = label - surface_label::first_plane;
  if (!region_.contains(x, y) || plane < 0 || plane >= planes) return false;
  const int column = (x - region_.x) / cell;
  const int row = (y - region_.y) / cell;
  Sum total;
  for (int r = std::max(0, row - reach); r <= std::min(rows_ - 1, row + reach); ++r) {
    for (int c = std::max(0, column - reach); c <= std::min(columns_ - 1, column + reach); ++c) {
      const Sum& sum = cell_at(c, r).sums[plane];
      total.blue += sum.blue;
      total.green += sum.green;
      total.red += sum.red;
      total.count += sum.count;
    }
  }
  constexpr std::uint32_t fewest_pixels = 24;
  if (total.count < fewest_pixels) return false;
  mean = Eigen::Array3f(static_cast<float>(total.blue), static_cast<float>(total.green),
                        static_cast<float>(total.red)) /
         static_cast<float>(total.count);
  return true;
}

}  // namespace diminish
