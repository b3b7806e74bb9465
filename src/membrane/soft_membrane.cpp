#include "membrane/soft_membrane.h"

#include <algorithm>

namespace diminish {
void SoftMembrane::begin(const Rect& region) {
  region_ = region;
  columns_ = region.width / cell + 2;
  rows_ = region.height / cell + 2;
  const auto count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  weights_.assign(count, 0.F);
  sums_.assign(count, Eigen::Array3f::Zero());
  values_.assign(count, Eigen::Array3f::Zero());
}

void SoftMembrane::add(int x, int y, const Eigen::Array3f& difference) {
  constexpr float each = full_weight * step * step / (cell * cell);
  const Eigen::Array3f relative = difference / largest_difference;
  if ((relative.abs() >= 1).any()) return;
  const float weight = each * (1 - relative.square()).square().prod();
  // The nearest grid point.
  const int column = (x - region_.x + cell / 2) / cell;
  const int row = (y - region_.y + cell / 2) / cell;
  const auto at = static_cast<std::size_t>(row * columns_ + column);
  weights_[at] += weight;
  sums_[at] += weight * difference;
}

void SoftMembrane::solve() {
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        const auto at = static_cast<std::size_t>(row * columns_ + column);
        const auto columns = static_cast<std::size_t>(columns_);
        Eigen::Array3f sum = sums_[at];
        float weight = weights_[at] + fading;
        const auto join = [&](bool is_there, std::size_t neighbour) {
          if (!is_there) return;
          sum += values_[neighbour];
          weight += 1;
        };
        join(column > 0, at - 1);
        join(column + 1 < columns_, at + 1);
        join(row > 0, at - columns);
        join(row + 1 < rows_, at + columns);
        values_[at] = sum / weight;
      }
    }
  }
}

void SoftMembrane::row(int y, int first, int last, float* correction) const {
  const int above = (y - region_.y) / cell;
  const float below_share = static_cast<float>((y - region_.y) % cell) / cell;
  const auto at = [&](int column) -> Eigen::Array3f {
    const auto upper = static_cast<std::size_t>(above * columns_ + column);
    const auto lower = upper + static_cast<std::size_t>(columns_);
    return (1 - below_share) * values_[upper] + below_share * values_[lower];
  };
  if (first >= last) return;
  Eigen::Array3f left = at(first / cell);
  for (int column = first / cell; column * cell < last; ++column) {
    const Eigen::Array3f right = at(column + 1);
    const int count = std::min(cell, region_.width - column * cell);
    for (int c = 0; c < 3; ++c) {
      float* to = correction + c * region_.width + column * cell;
      const float slope = (right[c] - left[c]) / cell;
      for (int i = 0; i < count; ++i) to[i] = left[c] + static_cast<float>(i) * slope;
    }
    left = right;
  }
}

}  // namespace diminish
