#pragma once

#include <Eigen/Sparse>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "diminish/image.h"

namespace diminish::testing {

/// Laplace's equation, written down pixel by pixel and solved by Eigen's direct sparse solver in
/// double precision: what the membrane's results are compared with.
///
///   sum over neighbours q of p (x_p - x_q)  =  source_p
///
/// A neighbour q is another unknown pixel or one with a given value; others do not count.
class LaplaceEquation {
 public:
  /// Three channels.
  using Values = Eigen::Array3d;

  /// unknown: not 0 where the solution is wanted.
  explicit LaplaceEquation(const Mask& unknown) : index_(unknown.width(), unknown.height(), -1) {
    for (int y = 0; y < unknown.height(); ++y) {
      for (int x = 0; x < unknown.width(); ++x) {
        if (unknown(x, y) == 0) continue;
        index_(x, y) = static_cast<int>(pixels_.size());
        pixels_.push_back({x, y});
      }
    }
    part_.resize(pixels_.size());
    for (std::size_t i = 0; i < part_.size(); ++i) part_[i] = i;
    is_held_.assign(pixels_.size(), false);
    right_ = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(pixels_.size()), 3);
  }

  bool is_unknown(int x, int y) const { return index_(x, y) >= 0; }
  /// Calls visit(x, y) for each unknown pixel.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const Place& pixel : pixels_) visit(pixel.x, pixel.y);
  }
  /// Calls visit(x, y) for each of a pixel's neighbours in the image.
  template <class Visit>
  void for_each_neighbour(int x, int y, const Visit& visit) const {
    constexpr int steps[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    for (const auto& [dx, dy] : steps) {
      if (index_.bounds().contains(x + dx, y + dy)) visit(x + dx, y + dy);
    }
  }

  /// Adds x_p - x_q to p's equation; to be called for q's, too.
  void join(int x, int y, int other_x, int other_y) {
    const int p = index_(x, y);
    const int q = index_(other_x, other_y);
    entries_.emplace_back(p, p, 1.0);
    entries_.emplace_back(p, q, -1.0);
    const std::size_t from = root(static_cast<std::size_t>(p));
    const std::size_t to = root(static_cast<std::size_t>(q));
    part_[from] = to;
    is_held_[to] = is_held_[to] || is_held_[from];
  }
  /// Adds x_p - value.
  void hold(int x, int y, const Values& value) {
    const int p = index_(x, y);
    entries_.emplace_back(p, p, 1.0);
    right_.row(p) += value.matrix().transpose();
    is_held_[root(static_cast<std::size_t>(p))] = true;
  }
  void add_source(int x, int y, const Values& source) {
    right_.row(index_(x, y)) += source.matrix().transpose();
  }

  /// Whether a pixel belongs to a part without any given value.
  bool is_loose(int x, int y) { return !is_held_[root(static_cast<std::size_t>(index_(x, y)))]; }

  /// The solution; 0 in loose parts, and where nothing was unknown.
  Image<Values> solve() {
    const auto count = static_cast<Eigen::Index>(pixels_.size());
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      const auto row = static_cast<int>(i);
      // Something, so that there is a solution.
      if (!is_held_[root(i)]) entries_.emplace_back(row, row, 1.0);
    }
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    if (solver.info() != Eigen::Success) throw std::runtime_error("no factorization");
    const Eigen::MatrixXd solution = solver.solve(right_);
    Image<Values> result(index_.width(), index_.height(), Values::Zero());
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      if (!is_held_[root(i)]) continue;
      result(pixels_[i].x, pixels_[i].y) =
          solution.row(static_cast<Eigen::Index>(i)).transpose().array();
    }
    return result;
  }

 private:
  struct Place {
    int x, y;
  };

  std::size_t root(std::size_t i) {
    while (part_[i] != i) i = part_[i] = part_[part_[i]];
    return i;
  }

  Image<int> index_;
  std::vector<Place> pixels_;
  std::vector<std::size_t> part_;  ///< a forest of pixels that hang together
  std::vector<bool> is_held_;      ///< by root
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::MatrixXd right_;
};

inline Eigen::Array3d levels(const Bgr& color) {
  return Eigen::Array3d(color.b, color.g, color.r);
}
inline Eigen::Array3d levels(const Bgra& color) {
  return Eigen::Array3d(color.b, color.g, color.r);
}

/// The harmonic filling, not rounded; 0 where nothing is missing.
inline Image<Eigen::Array3d> exact_filling(const Image<Bgr>& picture, const Mask& missing) {
  LaplaceEquation equation(missing);
  equation.for_each([&](int x, int y) {
    equation.for_each_neighbour(x, y, [&](int nx, int ny) {
      if (equation.is_unknown(nx, ny)) {
        equation.join(x, y, nx, ny);
      } else {
        equation.hold(x, y, levels(picture(nx, ny)));
      }
    });
  });
  return equation.solve();
}

/// Poisson seamless cloning, neither rounded nor clamped; 0 outside the mask and where the source
/// shows nothing. layer: 0 where it shows nothing; across the seam of two the gradient is 0. For
/// the result itself, not for its correction: the other way round than the membrane does it. Only
/// parts without a boundary are given in terms of the mean correction, that of the target's pixels
/// beside the mask.
template <class Pixel>
Image<Eigen::Array3d> exact_cloning(const Image<Bgr>& target, const Image<Pixel>& source,
                                    const Mask& mask, const Image<std::uint8_t>& layer) {
  Mask unknown = mask;
  for (std::size_t i = 0; i < unknown.size(); ++i) {
    if (layer.data()[i] == 0) unknown.data()[i] = 0;
  }
  LaplaceEquation equation(unknown);
  Mask is_beside(mask.width(), mask.height(), 0);
  equation.for_each([&](int x, int y) {
    equation.for_each_neighbour(x, y, [&](int nx, int ny) {
      if (layer(nx, ny) == 0) return;
      if (layer(nx, ny) == layer(x, y)) {
        equation.add_source(x, y, levels(source(x, y)) - levels(source(nx, ny)));
      }
      if (equation.is_unknown(nx, ny)) {
        equation.join(x, y, nx, ny);
      } else {
        equation.hold(x, y, levels(target(nx, ny)));
        is_beside(nx, ny) = 255;
      }
    });
  });
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  double count = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (is_beside(x, y) == 0) continue;
      sum += levels(target(x, y)) - levels(source(x, y));
      ++count;
    }
  }
  Image<Eigen::Array3d> result = equation.solve();
  equation.for_each([&](int x, int y) {
    if (equation.is_loose(x, y))
      result(x, y) = levels(source(x, y)) + (count > 0 ? sum / count : sum);
  });
  return result;
}

}  // namespace diminish::testing
