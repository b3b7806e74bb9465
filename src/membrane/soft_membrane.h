#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/tasks.h"
#include "diminish/image.h"

namespace diminish {

/// A smooth correction that follows differences where they are known and fades away from them.
///
/// Minimises, over a coarse grid of values m with bilinear interpolation between them,
///   sum of w (m - difference)^2  +  |gradient m|^2  +  fading |m|^2
/// so that, other than a membrane through Dirichlet values (Poisson cloning), it takes the average
/// of noisy differences, and outliers get no weight. These are far from what is usual around their
/// grid point: the median there where differences agree (a table shines towards one camera), and 0
/// elsewhere.
class SoftMembrane {
 public:
  static constexpr int cell = 16;  ///< pixels
  static constexpr int step = 4;   ///< differences are wanted of every `step`-th row and column
  /// Differences this many levels away from what is usual get no weight.
  static constexpr float largest_deviation = 15;
  /// Differences agree if a cell has half of its own at least, and half of these are this close, in
  /// levels, to their medians.
  static constexpr float largest_spread = 6;
  /// Medians beyond this show that the surfaces are different ones.
  static constexpr float largest_median = 40;
  /// What a cell full of differences weighs beside the gradient to one neighbour.
  static constexpr float full_weight = 32;
  static constexpr float fading = 0.2F;
  /// With this fading an error shrinks by a fifth or more with every sweep.
  static constexpr int sweeps = 24;

  void begin(const Rect& region);
  /// Calls visit(y) for each row of the region from which differences are wanted. Threads share
  /// them, so that no two add to the same grid point.
  template <class Visit>
  void for_each_row(const Visit& visit) const {
    for_tasks(static_cast<std::size_t>(rows_), [&](std::size_t row) {
      const int middle = static_cast<int>(row) * cell;
      const int end = std::min(middle + cell / 2, region_.height);
      for (int y = std::max(middle - cell / 2, 0); y < end; y += step) visit(region_.y + y);
    });
  }
  /// x, y: multiples of `step` from the region's corner. difference: in levels.
  void add(int x, int y, const Eigen::Array3f& difference);
  void solve();
  /// The channels, and 0.
  using Node = Eigen::Array4f;
  /// The corrections of a row of the region, one for every `cell`-th column from the region's left
  /// on, up to one beyond its right; between them they are linear.
  void row(int y, std::vector<Node>& nodes) const;

 private:
  static constexpr std::size_t cell_steps = cell / step;
  static constexpr std::size_t cell_samples = cell_steps * cell_steps;
  struct Differences {
    std::array<Eigen::Array3f, cell_samples> values;
    std::size_t count;
  };
  static Eigen::Array3f medians(std::span<const Eigen::Array3f> differences);
  static Eigen::Array3f usual(std::span<const Eigen::Array3f> differences);
  void weigh_differences(std::size_t at);
  /// To be indexed by the column; from row -1 on.
  Node* value_row(int row) { return values_.row(row + 1) + 1; }
  const Node* value_row(int row) const { return values_.row(row + 1) + 1; }

  Rect region_;
  int columns_ = 0, rows_ = 0;
  // Of grid points, row by row.
  std::vector<Differences> differences_;  ///< those nearest to each
  std::vector<float> weights_;
  std::vector<Node> sums_;
  Image<Node> values_;  ///< with a rim of zeros
};

}  // namespace diminish
