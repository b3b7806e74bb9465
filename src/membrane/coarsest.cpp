#include "membrane/coarsest.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace diminish {
namespace {

constexpr int none = -1;
constexpr int fixed = -2;

/// From a group's centre to the centre of a fixed cell outside its own 2x2.
double weight_to_fixed(double weight) {
  return weight / (1 + weight / 2);
}

}  // namespace

double MembraneCoarsest::work(int width, int height) {
  const int columns = (width + 1) / 2;
  const int rows = (height + 1) / 2;
  return std::pow(std::min(columns, rows), 3) * std::max(columns, rows);
}

void MembraneCoarsest::build(const MembraneLevel& level) {
  find_groups(level);
  find_edges(level);
  factorize();
  find_red(level);
}

void MembraneCoarsest::find_groups(const MembraneLevel& level) {
  groups_per_row_ = level.width + 2;
  group_of_.assign(static_cast<std::size_t>((level.height + 2) * groups_per_row_), none);
  cells_.clear();
  group_count_ = 0;
  const auto group = [&](int x, int y) -> int& {
    return group_of_[static_cast<std::size_t>((y + 1) * groups_per_row_ + x + 1)];
  };
  const float* inverse = level.inverse.data();
  const float* right = level.right.data();
  const float* down = level.down.data();
  const auto visit = [&](int x, int y) {
    // a b
    // c d
    const bool inside[2] = {x + 1 < level.width, y + 1 < level.height};
    int places[4][2] = {{x, y}, {x + 1, y}, {x, y + 1}, {x + 1, y + 1}};
    bool unknown[4];
    std::ptrdiff_t at[4];
    for (int k = 0; k < 4; ++k) {
      unknown[k] = false;
      if ((k % 2 == 1 && !inside[0]) || (k / 2 == 1 && !inside[1])) continue;
      at[k] = level.cell_at(places[k][0], places[k][1]);
      unknown[k] = inverse[at[k]] > 0;
      if (inverse[at[k]] < 0) group(places[k][0], places[k][1]) = fixed;
    }
    int part[4] = {0, 1, 2, 3};
    const auto join = [&](int p, int q, const float* weights) {
      if (!unknown[p] || !unknown[q] || !(weights[at[p]] > 0)) return;
      const int from = std::max(part[p], part[q]);
      const int to = std::min(part[p], part[q]);
      std::replace(std::begin(part), std::end(part), from, to);
    };
    join(0, 1, right);
    join(2, 3, right);
    join(0, 2, down);
    join(1, 3, down);
    int numbers[4] = {none, none, none, none};
    for (int k = 0; k < 4; ++k) {
      if (!unknown[k]) continue;
      int& number = numbers[part[k]];
      if (number == none) number = group_count_++;
      group(places[k][0], places[k][1]) = number;
      cells_.push_back({at[k], level.cell_at(places[k][0], places[k][1], 0), number,
                        (places[k][0] + places[k][1]) % 2 == 0});
    }
  };
  // Numbered along the shorter side first, because the matrix's band is as wide as that side.
  if (level.width <= level.height) {
    for (int y = 0; y < level.height; y += 2) {
      for (int x = 0; x < level.width; x += 2) visit(x, y);
    }
  } else {
    for (int x = 0; x < level.width; x += 2) {
      for (int y = 0; y < level.height; y += 2) visit(x, y);
    }
  }
}

void MembraneCoarsest::find_edges(const MembraneLevel& level) {
  edges_.clear();
  diagonal_.assign(static_cast<std::size_t>(group_count_), 0.0);
  bandwidth_ = 0;
  const auto connect = [&](int a, int b, double weight, bool same_block) {
    if (!(weight > 0) || a == b) return;
    if (a >= 0 && b >= 0) {
      // Twice as far apart as the cells are.
      edges_.push_back({std::max(a, b), std::min(a, b), weight / 2});
      bandwidth_ = std::max(bandwidth_, std::abs(a - b));
    } else if (std::max(a, b) >= 0 && std::min(a, b) == fixed) {
      diagonal_[static_cast<std::size_t>(std::max(a, b))] +=
          same_block ? weight : weight_to_fixed(weight);
    }
  };
  for (int y = 0; y < level.height; ++y) {
    const int* group = group_of_.data() + (y + 1) * groups_per_row_ + 1;
    for (int x = 0; x < level.width; ++x) {
      if (group[x] == none) continue;
      const std::ptrdiff_t at = level.cell_at(x, y);
      connect(group[x], group[x + 1], level.right.data()[at], x % 2 == 0);
      connect(group[x], group[x + groups_per_row_], level.down.data()[at], y % 2 == 0);
    }
  }
}

/// Cholesky's factor, row by row.
void MembraneCoarsest::factorize() {
  const auto row_size = static_cast<std::size_t>(bandwidth_) + 1;
  const auto count = static_cast<std::size_t>(group_count_);
  factor_.assign(count * row_size, 0.0);
  single_factor_.resize(count * row_size);
  solution_.resize(count);
  const auto row = [&](std::size_t i) { return factor_.data() + (i + 1) * row_size - 1; };
  for (const Edge& edge : edges_) {
    row(static_cast<std::size_t>(edge.a))[edge.b - edge.a] -= edge.weight;
    diagonal_[static_cast<std::size_t>(edge.a)] += edge.weight;
    diagonal_[static_cast<std::size_t>(edge.b)] += edge.weight;
  }
  for (std::size_t i = 0; i < count; ++i) {
    double* const own = row(i);
    const auto first = -static_cast<std::ptrdiff_t>(std::min(i, row_size - 1));
    for (std::ptrdiff_t j = first; j < 0; ++j) {
      const double* const other = row(i + static_cast<std::size_t>(j));
      // Columns from `first` to before j; those of the other row are counted from its own end.
      const auto length = static_cast<Eigen::Index>(
          j - std::max(first, j - static_cast<std::ptrdiff_t>(row_size - 1)));
      const double sum = Eigen::Map<const Eigen::VectorXd>(own + j - length, length)
                             .dot(Eigen::Map<const Eigen::VectorXd>(other - length, length));
      own[j] = (own[j] - sum) / other[0];
    }
    const auto length = static_cast<Eigen::Index>(-first);
    const double squares = Eigen::Map<const Eigen::VectorXd>(own - length, length).squaredNorm();
    // A part that is attached to nothing gets no correction.
    const double rest = diagonal_[i] - squares;
    own[0] = rest > 1e-9 * diagonal_[i] && rest > 0 ? std::sqrt(rest) : 1e6;
  }
  for (std::size_t i = 0; i < factor_.size(); ++i) {
    const bool is_diagonal = i % row_size == row_size - 1;
    single_factor_[i] = static_cast<float>(is_diagonal ? 1 / factor_[i] : factor_[i]);
  }
}

void MembraneCoarsest::find_red(const MembraneLevel& level) {
  red_.clear();
  const float* right = level.right.data();
  const float* down = level.down.data();
  for (const Cell& cell : cells_) {
    if (!cell.red) continue;
    // The columns beside are of the other parity: one place on, or none.
    const bool odd = (cell.single / level.pitch) % 2 == 1;
    Equation equation;
    equation.triple = cell.triple;
    equation.to_left = odd ? -level.pitch : level.pitch - 1;
    equation.to_right = odd ? 1 - level.pitch : level.pitch;
    equation.left = right[cell.single + equation.to_left];
    equation.right = right[cell.single];
    equation.up = down[cell.single - level.row_step()];
    equation.down = down[cell.single];
    equation.total = equation.left + equation.right + equation.up + equation.down;
    equation.group = cell.group;
    red_.push_back(equation);
  }
}

void MembraneCoarsest::correct(const MembraneLevel& level, const float* right_side, float* values) {
  if (group_count_ == 0) return;
  std::fill(solution_.begin(), solution_.end(), Eigen::Array4f::Zero());
  for (const Equation& equation : red_) {
    float residual[MembraneLevel::channels];
    for (int c = 0; c < MembraneLevel::channels; ++c) {
      const std::ptrdiff_t at = equation.triple + c * level.channel_step();
      const float* const own = values + at;
      residual[c] = right_side[at] + equation.left * own[equation.to_left] +
                    equation.right * own[equation.to_right] +
                    equation.up * own[-level.channel_row_step()] +
                    equation.down * own[level.channel_row_step()] - equation.total * own[0];
    }
    solution_[static_cast<std::size_t>(equation.group)] +=
        Eigen::Array4f(residual[0], residual[1], residual[2], 0);
  }
  const auto row_size = static_cast<std::ptrdiff_t>(bandwidth_) + 1;
  const auto count = static_cast<std::ptrdiff_t>(group_count_);
  const auto row = [&](std::ptrdiff_t i) { return single_factor_.data() + (i + 1) * row_size - 1; };
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const float* const factor = row(i);
    Eigen::Array4f* const own = solution_.data() + i;
    // Two sums, because one would wait for itself.
    Eigen::Array4f even = *own;
    Eigen::Array4f odd = Eigen::Array4f::Zero();
    std::ptrdiff_t j = -std::min(i, row_size - 1);
    for (; j + 1 < 0; j += 2) {
      even -= factor[j] * own[j];
      odd += factor[j + 1] * own[j + 1];
    }
    if (j < 0) even -= factor[j] * own[j];
    *own = (even - odd) * factor[0];
  }
  for (std::ptrdiff_t i = count; i-- > 0;) {
    const float* const factor = row(i);
    Eigen::Array4f* const own = solution_.data() + i;
    *own *= factor[0];
    for (std::ptrdiff_t j = -std::min(i, row_size - 1); j < 0; ++j) own[j] -= factor[j] * *own;
  }
  for (const Cell& cell : cells_) {
    const Eigen::Array4f& correction = solution_[static_cast<std::size_t>(cell.group)];
    for (int c = 0; c < MembraneLevel::channels; ++c) {
      values[cell.triple + c * level.channel_step()] += correction[c];
    }
  }
}

}  // namespace diminish
