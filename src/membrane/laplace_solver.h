#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// Solves Laplace's equation with sources on any set of pixels, three channels at a time:
///
///   sum over neighbours q of p (x_p - x_q)  +  anchor_p x_p  =  right_side_p
///
/// A neighbour that is not in the set does not count: the boundary is free (Neumann). A Dirichlet
/// neighbour of value v is 1 added to the anchor and v to the right side. Every connected part
/// needs an anchor somewhere.
///
/// Conjugate gradients, preconditioned by one multigrid W-cycle on 2x2 aggregates (Braess 1995),
/// which any mask, however thin or scattered, coarsens to without growing. Cost: linear in the
/// number of pixels.
class LaplaceSolver {
 public:
  using Channels = Eigen::Array3f;

  /// Starts a problem inside a window of this size, without pixels.
  void begin(int width, int height);
  /// Adds a pixel. In any order, each once.
  void add(int x, int y) { index_(x, y) = 0; }
  /// Numbers the pixels and joins neighbours; nothing can be added then.
  void connect();

  std::size_t size() const { return levels_.front().size(); }
  /// A pixel's number; -1 if it was not added.
  int index(int x, int y) const { return index_(x, y); }
  /// The numbers of a pixel's left, right, upper and lower neighbours; -1 where there is none.
  std::array<int, 4> neighbours(int index) const {
    const Level::Cell& cell = levels_.front().cells[static_cast<std::size_t>(index)];
    return {cell.left, cell.right, cell.up, cell.down};
  }
  void add_anchor(int index, float weight, const Channels& value) {
    Level& level = levels_.front();
    level.anchor[static_cast<std::size_t>(index)] += weight;
    level.right_side[static_cast<std::size_t>(index)] += weight * value;
  }
  void add_source(int index, const Channels& value) {
    levels_.front().right_side[static_cast<std::size_t>(index)] += value;
  }

  /// Solves until the estimated error is below `tolerance` everywhere; the solution by pixel
  /// number.
  const std::vector<Channels>& solve(float tolerance);

 private:
  /// One grid of the hierarchy: cells with weighted edges to their right and lower neighbours.
  struct Level {
    struct Cell {
      int left = -1, right = -1, up = -1, down = -1;
      float right_weight = 0, down_weight = 0;
    };
    std::vector<Cell> cells;
    std::vector<float> anchor, inverse_diagonal;
    std::vector<int> parent;  ///< the cell of the next level that this one belongs to
    std::vector<Channels> right_side, x;

    std::size_t size() const { return cells.size(); }
    void resize(std::size_t count);
    void finish();
    Channels neighbours(std::size_t i, const std::vector<Channels>& values) const;
    Channels apply(std::size_t i, const std::vector<Channels>& values) const;
    void relax(std::size_t i);
  };

  void coarsen();
  void cycle(std::size_t level);
  void precondition(const std::vector<Channels>& residual, std::vector<Channels>& result);

  Image<int> index_;
  Image<int> coarse_index_[2];
  std::vector<Level> levels_{1};
  std::size_t level_count_ = 1;
  std::vector<Channels> solution_, residual_, direction_, image_, preconditioned_;
};

}  // namespace diminish
