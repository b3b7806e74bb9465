#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "membrane/level.h"

namespace diminish {

/// Where MembraneSolver's hierarchy ends: corrections of a level by one number for each group of up
/// to 2x2 cells that hang together, found exactly. Unlike a coarser level's cells, the groups of
/// regions with a narrow gap between them stay apart: each region, however long and thin, gets the
/// correction that its own boundary values ask for.
class MembraneCoarsest {
 public:
  /// The multiplications that a level of width x height cells takes.
  static double work(int width, int height);

  /// Reads a level's cells and weights, and factorizes.
  void build(const MembraneLevel& level);

  /// Adds the correction to `values`, which have just been relaxed.
  void correct(const MembraneLevel& level, const float* right_side, float* values);

 private:
  /// An unknown cell: where it is in arrays of one value and of three, and its group.
  struct Cell {
    std::ptrdiff_t single, triple;
    int group;
    bool red;
  };
  /// Of a cell that is relaxed first: what is left of it has to be looked up.
  struct Equation {
    std::ptrdiff_t triple, to_left, to_right;
    float left, right, up, down, total;  ///< weights
    int group;
  };
  struct Edge {
    int a, b;
    double weight;
  };

  void find_groups(const MembraneLevel& level);
  void find_edges(const MembraneLevel& level);
  void factorize();
  void find_red(const MembraneLevel& level);

  std::vector<int> group_of_;  ///< of each cell of the level, with a margin; or none, fixed
  std::ptrdiff_t groups_per_row_ = 0;
  std::vector<Cell> cells_;
  int group_count_ = 0;
  std::vector<Equation> red_;
  std::vector<Edge> edges_;
  std::vector<double> diagonal_;
  int bandwidth_ = 0;
  std::vector<double> factor_;        ///< rows of bandwidth + 1; the last is the diagonal
  std::vector<float> single_factor_;  ///< likewise, the reciprocal diagonal
  std::vector<Eigen::Array4f> solution_;
};

}  // namespace diminish
