#include "membrane/soft_membrane.h"

#include <algorithm>

#include "core/robust.h"

namespace diminish {
void SoftMembrane::begin(const Rect& region) {
  region_ = region;
  columns_ = region.width / cell + 2;
  rows_ = region.height / cell + 2;
  weights_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0.F);
  sums_.assign(weights_.size(), Node::Zero());
  differences_.resize(weights_.size());
  for (Differences& differences : differences_) differences.count = 0;
  values_.resize(columns_ + 2, rows_ + 2, Node::Zero());
}

void SoftMembrane::add(int x, int y, const Eigen::Array3f& difference) {
  // The nearest grid point.
  const int column = (x - region_.x + cell / 2) / cell;
  const int row = (y - region_.y + cell / 2) / cell;
  Differences& there =
      differences_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                   static_cast<std::size_t>(column)];
  there.values[there.count++] = difference;
}

/// Of each channel.
Eigen::Array3f SoftMembrane::medians(std::span<const Eigen::Array3f> differences) {
  std::array<float, cell_samples> values{};
  const auto end = values.begin() + static_cast<std::ptrdiff_t>(differences.size());
  Eigen::Array3f medians;
  for (int channel = 0; channel < 3; ++channel) {
    std::transform(differences.begin(), differences.end(), values.begin(),
                   [&](const Eigen::Array3f& difference) { return difference[channel]; });
    medians[channel] = median(values.begin(), end);
  }
  return medians;
}

/// What to weigh a grid point's differences about.
Eigen::Array3f SoftMembrane::usual(std::span<const Eigen::Array3f> differences) {
  if (2 * differences.size() < cell_samples) return Eigen::Array3f::Zero();
  const Eigen::Array3f center = medians(differences);
  if ((center.abs() > largest_median).any()) return Eigen::Array3f::Zero();
  // Outliers move a median a little; the second one is without them.
  std::array<float, cell_samples> deviations{};
  std::array<Eigen::Array3f, cell_samples> near;
  auto* deviations_end = deviations.data();
  std::size_t count = 0;
  for (const Eigen::Array3f& difference : differences) {
    const float deviation = (difference - center).abs().maxCoeff();
    *deviations_end++ = deviation;
    if (deviation < largest_deviation) near[count++] = difference;
  }
  if (median(deviations.data(), deviations_end) > largest_spread) return Eigen::Array3f::Zero();
  if (2 * count < cell_samples) return Eigen::Array3f::Zero();
  return count == differences.size() ? center : medians({near.data(), count});
}

/// Of a grid point.
void SoftMembrane::weigh_differences(std::size_t at) {
  constexpr float each = full_weight / cell_samples;
  const std::span differences(differences_[at].values.data(), differences_[at].count);
  if (differences.empty()) return;
  const Eigen::Array3f center = usual(differences);
  for (const Eigen::Array3f& difference : differences) {
    const Eigen::Array3f relative = (difference - center) / largest_deviation;
    if ((relative.abs() >= 1).any()) continue;
    const float weight = each * (1 - relative.square()).square().prod();
    weights_[at] += weight;
    sums_[at].head<3>() += weight * difference;
  }
}

void SoftMembrane::solve() {
  const auto columns = static_cast<std::size_t>(columns_);
  for_tasks(static_cast<std::size_t>(rows_), [&](std::size_t row) {
    for (std::size_t column = 0; column < columns; ++column) {
      weigh_differences(row * columns + column);
    }
  });
  // From here on with the gradients to the neighbours that are there, and the fading.
  float* own = weights_.data();
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      float& weight = *own++;
      weight += fading;
      for (const bool is_there : {column > 0, column + 1 < columns_, row > 0, row + 1 < rows_}) {
        if (is_there) weight += 1;
      }
    }
  }
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const float* weight = weights_.data();
    const Node* sum = sums_.data();
    for (int row = 0; row < rows_; ++row) {
      Node* const here = value_row(row);
      const Node* const above = value_row(row - 1);
      const Node* const below = value_row(row + 1);
      for (int column = 0; column < columns_; ++column) {
        const Node all =
            *sum++ + here[column - 1] + here[column + 1] + above[column] + below[column];
        here[column] = all / *weight++;
      }
    }
  }
}

void SoftMembrane::row(int y, std::vector<Node>& nodes) const {
  const int above = (y - region_.y) / cell;
  const float below_share = static_cast<float>((y - region_.y) % cell) / cell;
  const Node* const upper = value_row(above);
  const Node* const lower = value_row(above + 1);
  nodes.clear();
  for (int column = 0; column < columns_; ++column) {
    nodes.emplace_back((1 - below_share) * upper[column] + below_share * lower[column]);
  }
}

}  // namespace diminish
