#pragma once

#include <Eigen/Core>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// A smooth correction that follows differences where they are known and fades away from them.
///
/// Minimises, over a coarse grid of values m with bilinear interpolation between them,
///   sum of w (m - difference)^2  +  |gradient m|^2  +  fading |m|^2
/// so that, other than a membrane through Dirichlet values (Poisson cloning), it takes the average
/// of noisy differences, and outliers, which get no weight, leave no trace.
class SoftMembrane {
 public:
  static constexpr int cell = 16;  ///< pixels
  static constexpr int step = 4;   ///< differences are wanted of every `step`-th row and column
  /// Differences of this many levels are of other surfaces, or shadows: they get no weight.
  static constexpr float largest_difference = 15;
  /// What a cell full of differences weighs beside the gradient to one neighbour.
  static constexpr float full_weight = 32;
  static constexpr float fading = 0.2F;
  /// With this fading an error shrinks by a fifth or more with every sweep.
  static constexpr int sweeps = 24;

  void begin(const Rect& region);
  /// difference: in levels.
  void add(int x, int y, const Eigen::Array3f& difference);
  void solve();
  /// The channels, and 0.
  using Node = Eigen::Array4f;
  /// The corrections of a row of the region, one for every `cell`-th column from the region's left
  /// on, up to one beyond its right; between them they are linear.
  void row(int y, std::vector<Node>& nodes) const;

 private:
  /// To be indexed by the column; from row -1 on.
  Node* value_row(int row) { return values_.row(row + 1) + 1; }
  const Node* value_row(int row) const { return values_.row(row + 1) + 1; }

  std::size_t index_of(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  Rect region_;
  int columns_ = 0, rows_ = 0;
  std::vector<float> weights_;
  std::vector<Node> sums_;
  Image<Node> values_;  ///< with a rim of zeros
};

}  // namespace diminish
