#include "membrane/laplace_solver.h"

#include <algorithm>
#include <array>

namespace diminish {
namespace {

using Channels = LaplaceSolver::Channels;
using Sums = Eigen::Array3d;

constexpr int max_iterations = 200;
constexpr std::size_t coarsest_size = 32;
constexpr int coarsest_sweeps = 40;

Sums dot(const std::vector<Channels>& a, const std::vector<Channels>& b) {
  Sums sum = Sums::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] * b[i]).cast<double>();
  return sum;
}

/// a / b per channel; a channel that is solved already (b = 0) rests.
Channels quotient(const Sums& a, const Sums& b) {
  return (b > 0).select(a / (b > 0).select(b, 1.0), 0.0).cast<float>();
}

}  // namespace

void LaplaceSolver::Level::resize(std::size_t count) {
  cells.assign(count, {});
  anchor.assign(count, 0.F);
  inverse_diagonal.resize(count);
  parent.resize(count);
  right_side.assign(count, Channels::Zero());
  x.resize(count);
}

void LaplaceSolver::Level::finish() {
  for (std::size_t i = 0; i < size(); ++i) {
    const Cell& cell = cells[i];
    float diagonal = anchor[i] + cell.right_weight + cell.down_weight;
    if (cell.left >= 0) diagonal += cells[static_cast<std::size_t>(cell.left)].right_weight;
    if (cell.up >= 0) diagonal += cells[static_cast<std::size_t>(cell.up)].down_weight;
    inverse_diagonal[i] = diagonal > 0 ? 1 / diagonal : 0;
  }
}

Channels LaplaceSolver::Level::neighbours(std::size_t i,
                                          const std::vector<Channels>& values) const {
  const Cell& cell = cells[i];
  Channels sum = Channels::Zero();
  const auto add = [&](int neighbour, float weight) {
    sum += weight * values[static_cast<std::size_t>(neighbour)];
  };
  if (cell.left >= 0) add(cell.left, cells[static_cast<std::size_t>(cell.left)].right_weight);
  if (cell.right >= 0) add(cell.right, cell.right_weight);
  if (cell.up >= 0) add(cell.up, cells[static_cast<std::size_t>(cell.up)].down_weight);
  if (cell.down >= 0) add(cell.down, cell.down_weight);
  return sum;
}

Channels LaplaceSolver::Level::apply(std::size_t i, const std::vector<Channels>& values) const {
  if (inverse_diagonal[i] == 0) return Channels::Zero();
  return values[i] / inverse_diagonal[i] - neighbours(i, values);
}

void LaplaceSolver::Level::relax(std::size_t i) {
  x[i] = inverse_diagonal[i] * (right_side[i] + neighbours(i, x));
}

void LaplaceSolver::begin(int width, int height) {
  index_.resize(width, height, -1);
}

void LaplaceSolver::connect() {
  int count = 0;
  for (int& index : index_) {
    if (index >= 0) index = count++;
  }
  Level& level = levels_.front();
  level.resize(static_cast<std::size_t>(count));
  for (int y = 0; y < index_.height(); ++y) {
    for (int x = 0; x < index_.width(); ++x) {
      if (index_(x, y) < 0) continue;
      Level::Cell& cell = level.cells[static_cast<std::size_t>(index_(x, y))];
      if (x > 0) cell.left = index_(x - 1, y);
      if (y > 0) cell.up = index_(x, y - 1);
      if (x + 1 < index_.width()) cell.right = index_(x + 1, y);
      if (y + 1 < index_.height()) cell.down = index_(x, y + 1);
      if (cell.right >= 0) cell.right_weight = 1;
      if (cell.down >= 0) cell.down_weight = 1;
    }
  }
}

// A coarse cell is a 2x2 block in which there is any cell. Two fine edges join neighbouring full
// blocks, of which the coarse edge gets half: constant interpolation makes the coarse grid too
// stiff by this factor.
void LaplaceSolver::coarsen() {
  levels_.front().finish();
  level_count_ = 1;
  const Image<int>* fine_index = &index_;
  while (levels_[level_count_ - 1].size() > coarsest_size) {
    if (levels_.size() == level_count_) levels_.emplace_back();
    Level& fine = levels_[level_count_ - 1];
    Level& coarse = levels_[level_count_];
    Image<int>& coarse_index = coarse_index_[level_count_ % 2];
    coarse_index.resize((fine_index->width() + 1) / 2, (fine_index->height() + 1) / 2, -1);
    for (int y = 0; y < fine_index->height(); ++y) {
      for (int x = 0; x < fine_index->width(); ++x) {
        if ((*fine_index)(x, y) >= 0) coarse_index(x / 2, y / 2) = 0;
      }
    }
    int count = 0;
    for (int& index : coarse_index) {
      if (index >= 0) index = count++;
    }
    coarse.resize(static_cast<std::size_t>(count));
    for (int y = 0; y < fine_index->height(); ++y) {
      for (int x = 0; x < fine_index->width(); ++x) {
        if ((*fine_index)(x, y) < 0) continue;
        const auto i = static_cast<std::size_t>((*fine_index)(x, y));
        const int parent = coarse_index(x / 2, y / 2);
        fine.parent[i] = parent;
        Level::Cell& cell = coarse.cells[static_cast<std::size_t>(parent)];
        coarse.anchor[static_cast<std::size_t>(parent)] += fine.anchor[i];
        if (x % 2 == 1 && fine.cells[i].right >= 0) {
          cell.right = coarse_index(x / 2 + 1, y / 2);
          cell.right_weight += 0.5F * fine.cells[i].right_weight;
        }
        if (y % 2 == 1 && fine.cells[i].down >= 0) {
          cell.down = coarse_index(x / 2, y / 2 + 1);
          cell.down_weight += 0.5F * fine.cells[i].down_weight;
        }
      }
    }
    for (std::size_t i = 0; i < coarse.size(); ++i) {
      const Level::Cell& cell = coarse.cells[i];
      if (cell.right >= 0)
        coarse.cells[static_cast<std::size_t>(cell.right)].left = static_cast<int>(i);
      if (cell.down >= 0)
        coarse.cells[static_cast<std::size_t>(cell.down)].up = static_cast<int>(i);
    }
    coarse.finish();
    // Isolated cells do not coarsen.
    if (coarse.size() == fine.size()) break;
    fine_index = &coarse_index;
    ++level_count_;
  }
}

// A W-cycle, which corrects on each coarser grid twice, as constant interpolation alone carries
// corrections poorly over many levels. Gauss-Seidel forwards before and backwards after the coarse
// correction: symmetric, as conjugate gradients need it.
void LaplaceSolver::cycle(std::size_t number) {
  Level& level = levels_[number];
  if (number + 1 == level_count_) {
    for (int sweep = 0; sweep < coarsest_sweeps; ++sweep) {
      for (std::size_t i = 0; i < level.size(); ++i) level.relax(i);
      for (std::size_t i = level.size(); i-- > 0;) level.relax(i);
    }
    return;
  }
  for (std::size_t i = 0; i < level.size(); ++i) level.relax(i);
  Level& coarse = levels_[number + 1];
  std::fill(coarse.right_side.begin(), coarse.right_side.end(), Channels::Zero());
  for (std::size_t i = 0; i < level.size(); ++i) {
    coarse.right_side[static_cast<std::size_t>(level.parent[i])] +=
        level.right_side[i] - level.apply(i, level.x);
  }
  std::fill(coarse.x.begin(), coarse.x.end(), Channels::Zero());
  cycle(number + 1);
  if (number + 2 < level_count_) cycle(number + 1);
  for (std::size_t i = 0; i < level.size(); ++i) {
    level.x[i] += coarse.x[static_cast<std::size_t>(level.parent[i])];
  }
  for (std::size_t i = level.size(); i-- > 0;) level.relax(i);
}

void LaplaceSolver::precondition(const std::vector<Channels>& residual,
                                 std::vector<Channels>& result) {
  Level& finest = levels_.front();
  finest.right_side = residual;
  std::fill(finest.x.begin(), finest.x.end(), Channels::Zero());
  cycle(0);
  result = finest.x;
}

const std::vector<LaplaceSolver::Channels>& LaplaceSolver::solve(float tolerance) {
  const std::size_t count = size();
  coarsen();
  const Level& level = levels_.front();
  solution_.assign(count, Channels::Zero());
  residual_ = level.right_side;
  image_.resize(count);
  precondition(residual_, preconditioned_);
  direction_ = preconditioned_;
  Sums product = dot(residual_, preconditioned_);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    for (std::size_t i = 0; i < count; ++i) image_[i] = level.apply(i, direction_);
    const Channels step = quotient(product, dot(direction_, image_));
    for (std::size_t i = 0; i < count; ++i) {
      solution_[i] += step * direction_[i];
      residual_[i] -= step * image_[i];
    }
    precondition(residual_, preconditioned_);
    // The preconditioned residual is the preconditioner's estimate of the error.
    float error = 0;
    for (const Channels& value : preconditioned_) {
      error = std::max(error, value.abs().maxCoeff());
    }
    if (error < tolerance) break;
    const Sums next_product = dot(residual_, preconditioned_);
    const Channels momentum = quotient(next_product, product);
    for (std::size_t i = 0; i < count; ++i) {
      direction_[i] = preconditioned_[i] + momentum * direction_[i];
    }
    product = next_product;
  }
  return solution_;
}

}  // namespace diminish
