#include "reconstruct/shadow_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/robust.h"

namespace diminish {
namespace {

constexpr int passes = 6;
constexpr int lenient_passes = 3;
constexpr float largest_shadow = 0.9F;
/// Each pass begins with the shares of the last.
constexpr int sweeps = 8;
/// What few points do not tell is no shadow.
constexpr float ridge = 2;
/// Nor is what a direction hardly explains.
constexpr float least_share = 0.007F;
/// Of the squared error in the shadow without it, what a fit may leave.
constexpr float most_unexplained = 0.6F;
/// Objects do not hide all of the sky; a fit that says so explains texture.
constexpr float most_shares = 0.75F;
/// Between the channels' shares: what differs more is not a shadow but a colour.
constexpr float largest_ratio = 1.6F;
constexpr std::size_t fewest_in_shadow = 12;

Eigen::Matrix<float, 6, 1> terms(const Eigen::Vector2f& p) {
  Eigen::Matrix<float, 6, 1> result;
  result << 1, p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y();
  return result;
}

}  // namespace

void ShadowFit::begin(std::size_t directions) {
  points_.clear();
  hidden_.clear();
  shares_.setZero(static_cast<Eigen::Index>(directions), brightness + 1);
}

void ShadowFit::add(const Eigen::Vector2f& place, const Eigen::Array3f& levels,
                    const std::vector<std::uint8_t>& hidden) {
  const auto first = static_cast<std::uint32_t>(hidden_.size());
  hidden_.insert(hidden_.end(), hidden.begin(), hidden.end());
  points_.push_back(
      {place, levels, first, static_cast<std::uint32_t>(hidden_.size()), 1.F, 1.F, 1.F});
}

bool ShadowFit::fit() {
  if (points_.empty()) return false;
  // The field begins as that of the points that nothing can hide.
  for (Point& point : points_) point.weight = point.first_hidden == point.last_hidden ? 1.F : 0.1F;
  for (int pass = 0; pass < passes; ++pass) {
    fit_field(brightness);
    weigh(pass < lenient_passes ? largest_shadow : 0);
    add_up_squares();
    fit_shares(brightness);
  }
  if (!explains()) return false;
  for (int c = 0; c < brightness; ++c) {
    for (Point& point : points_) point.light = 1 - hidden_share(point, brightness);
    fit_field(c);
    fit_shares(c);
  }
  const Eigen::Array3f sums = shares_.leftCols<brightness>().colwise().sum().transpose().array();
  return sums.maxCoeff() <= most_shares && sums.maxCoeff() <= largest_ratio * sums.minCoeff();
}

Eigen::Array3f ShadowFit::share(std::size_t direction) const {
  return shares_.row(static_cast<Eigen::Index>(direction)).head<brightness>().transpose().array();
}

float ShadowFit::hidden_share(const Point& point, int channel) const {
  float sum = 0;
  for (std::uint32_t i = point.first_hidden; i < point.last_hidden; ++i) {
    sum += shares_(hidden_[i], channel);
  }
  return std::min(sum, 1 - least_light);
}

/// The light being as it is.
void ShadowFit::fit_field(int channel) {
  Eigen::Matrix<float, 6, 6> squares = Eigen::Matrix<float, 6, 6>::Identity() * 1e-3F;
  Terms products = Terms::Zero();
  for (const Point& point : points_) {
    const Terms lit = point.light * terms(point.place);
    squares += (point.weight * lit) * lit.transpose();
    products += (point.weight * level(point, channel)) * lit;
  }
  const Terms solution = squares.ldlt().solve(products);
  for (Point& point : points_) {
    constexpr float least_level = 4;
    point.field = std::max(least_level, solution.dot(terms(point.place)));
  }
}

/// end_in_shadow: residuals below this are not yet mistakes where there may be a shadow.
void ShadowFit::weigh(float end_in_shadow) {
  residuals_.clear();
  const auto residual = [](const Point& point) {
    return std::abs(level(point, brightness) / point.field - point.light);
  };
  for (const Point& point : points_) residuals_.push_back(residual(point));
  constexpr float least_scale = 0.02F;
  const float end = 4.7F * std::max(least_scale, 1.48F * median(residuals_));
  for (Point& point : points_) {
    const bool may_be_hidden = point.first_hidden != point.last_hidden;
    point.weight =
        tukey_weight(residual(point), may_be_hidden ? std::max(end, end_in_shadow) : end);
  }
}

/// The left side of the shares' equations. Directions come in order: half of it is enough.
void ShadowFit::add_up_squares() {
  const Eigen::Index count = shares_.rows();
  squares_.setZero(count, count);
  for (const Point& point : points_) {
    for (std::uint32_t i = point.first_hidden; i < point.last_hidden; ++i) {
      float* column = squares_.data() + count * hidden_[i];
      for (std::uint32_t j = i; j < point.last_hidden; ++j) column[hidden_[j]] += point.weight;
    }
  }
  squares_.triangularView<Eigen::StrictlyUpper>() = squares_.transpose();
  squares_.diagonal().array() += ridge;
}

/// The field being as it is: least squares without negative shares, one after the other.
void ShadowFit::fit_shares(int channel) {
  const Eigen::Index count = shares_.rows();
  products_.setZero(count);
  for (const Point& point : points_) {
    const float darker = point.weight * (1 - level(point, channel) / point.field);
    for (std::uint32_t i = point.first_hidden; i < point.last_hidden; ++i) {
      products_[hidden_[i]] += darker;
    }
  }
  auto shares = shares_.col(channel);
  if (channel != brightness) shares = shares_.col(brightness);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (Eigen::Index d = 0; d < count; ++d) {
      const float rest = products_[d] - squares_.col(d).dot(shares);
      shares[d] = std::max(0.F, shares[d] + rest / squares_(d, d) - least_share);
    }
  }
  for (Point& point : points_) point.light = 1 - hidden_share(point, channel);
}

bool ShadowFit::explains() const {
  float with = 0;
  float without = 0;
  std::size_t in_shadow = 0;
  for (const Point& point : points_) {
    constexpr float shadow = 0.95F;
    if (point.light > shadow) continue;
    const float relative = level(point, brightness) / point.field;
    with += point.weight * (relative - point.light) * (relative - point.light);
    without += point.weight * (relative - 1) * (relative - 1);
    ++in_shadow;
  }
  return in_shadow >= fewest_in_shadow && with < most_unexplained * without &&
         shares_.col(brightness).sum() <= most_shares;
}

}  // namespace diminish
