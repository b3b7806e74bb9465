#include "scene/shadow_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/robust.h"
#include "geometry/symmetric_solver.h"

namespace diminish {
namespace {

constexpr int passes_of_fit = 6;
constexpr int lenient_passes = 3;
constexpr float largest_shadow = 0.9F;
/// Each pass starts with the shares of the last one.
constexpr int sweeps = 8;
/// Pulls shares that few points determine towards 0.
constexpr float ridge = 2;
/// Below this a direction explains hardly anything and gets no share.
constexpr float smallest_share = 0.007F;
/// The largest share of the squared error in the shadow that a fit may leave.
constexpr float most_unexplained = 0.6F;
/// ... together with the share that is a colour. On the recordings it is at most .37 of shadows,
/// and at least .46 of dark posters.
constexpr float most_unexplained_or_color = 0.41F;
/// With less light than this a point is in the shadow.
constexpr float shadow_light = 0.95F;
/// Objects do not hide the whole sky. A fit that says so explains texture.
constexpr float most_shares = 0.75F;
/// The largest difference between the channels' shares: a larger one is a colour, not a shadow.
constexpr float largest_ratio = 1.6F;
constexpr std::size_t fewest_in_shadow = 12;

constexpr int terms = 6;
/// The index of x^a y^b in Monomials.
constexpr int place_of(int a, int b) {
  return (a + b) * (a + b + 1) / 2 + b;
}

}  // namespace

void ShadowFit::begin(std::size_t directions) {
  points_.clear();
  hidden_.clear();
  shares_.setZero(static_cast<Eigen::Index>(directions), brightness + 1);
}

void ShadowFit::add(const Eigen::Vector2f& place, const Eigen::Array3f& levels,
                    const std::vector<std::uint8_t>& hidden) {
  Point& point = points_.emplace_back();
  point.monomials.setZero();
  float of_x[5] = {1};
  for (int i = 1; i < 5; ++i) of_x[i] = of_x[i - 1] * place.x();
  float of_y = 1;
  for (int b = 0; b < 5; ++b, of_y *= place.y()) {
    for (int a = 0; a + b < 5; ++a) point.monomials[place_of(a, b)] = of_x[a] * of_y;
  }
  point.levels << levels, levels.mean();
  point.first_hidden = static_cast<std::uint32_t>(hidden_.size());
  hidden_.insert(hidden_.end(), hidden.begin(), hidden.end());
  point.last_hidden = static_cast<std::uint32_t>(hidden_.size());
  point.light = point.field = 1;
}

bool ShadowFit::fit() {
  if (points_.empty()) return false;
  sort_by_direction();
  // The field starts from the points that nothing can hide.
  for (Point& point : points_) point.weight = point.first_hidden == point.last_hidden ? 1.F : 0.1F;
  for (int pass = 0; pass < passes_of_fit; ++pass) {
    fit_field(brightness);
    weigh(pass < lenient_passes ? largest_shadow : 0);
    fit_shares(brightness);
    find_light();
  }
  if (!explains()) return false;
  for (int c = 0; c < brightness; ++c) {
    fit_field(c);
    fit_shares(c);
    for (Point& point : points_) point.relative[c] = point.levels[c] / point.field;
  }
  if (!is_colorless()) return false;
  const Eigen::Array3f sums = shares_.leftCols<brightness>().colwise().sum().transpose().array();
  return sums.maxCoeff() <= largest_ratio * sums.minCoeff();
}

Eigen::Array3f ShadowFit::share(std::size_t direction) const {
  return shares_.row(static_cast<Eigen::Index>(direction)).head<brightness>().transpose().array();
}

void ShadowFit::sort_by_direction() {
  first_point_.assign(static_cast<std::size_t>(shares_.rows()) + 1, 0);
  for (const std::uint8_t direction : hidden_) ++first_point_[direction];
  // Filled from the end, so that each begin ends up in place.
  std::partial_sum(first_point_.begin(), first_point_.end(), first_point_.begin());
  hidden_points_.resize(hidden_.size());
  for (std::size_t p = points_.size(); p-- > 0;) {
    for (std::uint32_t i = points_[p].first_hidden; i < points_[p].last_hidden; ++i) {
      hidden_points_[--first_point_[hidden_[i]]] = static_cast<std::uint32_t>(p);
    }
  }
}

/// Fits the field with the light fixed. The sums of products of terms are monomials too: fifteen
/// sums instead of thirty-six.
void ShadowFit::fit_field(int channel) {
  Monomials moments = Monomials::Zero();
  Eigen::Array<float, 8, 1> sums = Eigen::Array<float, 8, 1>::Zero();
  for (const Point& point : points_) {
    const float lit = point.weight * point.light;
    moments += (lit * point.light) * point.monomials;
    sums += (lit * point.levels[channel]) * point.monomials.head<8>();
  }
  Eigen::Matrix<float, terms, terms> squares;
  for (int b = 0; b < 3; ++b) {
    for (int a = 0; a + b < 3; ++a) {
      for (int d = 0; d < 3; ++d) {
        for (int c = 0; c + d < 3; ++c) {
          squares(place_of(a, b), place_of(c, d)) = moments[place_of(a + c, b + d)];
        }
      }
    }
  }
  squares.diagonal().array() += 1e-3F;
  const Eigen::Matrix<float, terms, 1> products = sums.head<terms>();
  Eigen::Array<float, 8, 1> solution = Eigen::Array<float, 8, 1>::Zero();
  solution.head<terms>() = solve_symmetric(squares, products).array();
  for (Point& point : points_) {
    constexpr float least_level = 4;
    point.field = std::max(least_level, (solution * point.monomials.head<8>()).sum());
  }
}

/// end_in_shadow: smaller residuals do not count as outliers where there may be a shadow.
void ShadowFit::weigh(float end_in_shadow) {
  residuals_.clear();
  const auto residual = [](const Point& point) {
    return std::abs(point.levels[brightness] / point.field - point.light);
  };
  for (const Point& point : points_) residuals_.push_back(residual(point));
  constexpr float least_scale = 0.02F;
  const float end = 4.7F * std::max(least_scale, 1.48F * median(residuals_));
  for (Point& point : points_) {
    const bool may_be_hidden = point.first_hidden != point.last_hidden;
    point.weight =
        tukey_weight(residual(point), may_be_hidden ? std::max(end, end_in_shadow) : end);
  }
  has_column_.assign(static_cast<std::size_t>(shares_.rows()), 0);
}

/// The column of the normal equations for this direction. Most directions get no share, so their
/// columns are never needed.
const float* ShadowFit::column(std::size_t direction) {
  float* const sums = squares_.col(static_cast<Eigen::Index>(direction)).data();
  if (has_column_[direction] != 0) return sums;
  has_column_[direction] = 1;
  std::fill_n(sums, squares_.rows(), 0.F);
  for (std::uint32_t k = first_point_[direction]; k < first_point_[direction + 1]; ++k) {
    const Point& point = points_[hidden_points_[k]];
    for (std::uint32_t i = point.first_hidden; i < point.last_hidden; ++i) {
      sums[hidden_[i]] += point.weight;
    }
  }
  sums[direction] += ridge;
  return sums;
}

/// Fits the shares with the field fixed: least squares without negative shares, one after the
/// other.
void ShadowFit::fit_shares(int channel) {
  const Eigen::Index count = shares_.rows();
  squares_.resize(count, count);
  weights_.clear();
  darker_.clear();
  for (const Point& point : points_) {
    weights_.push_back(point.weight);
    darker_.push_back(point.weight * (1 - point.levels[channel] / point.field));
  }
  diagonal_.resize(count);
  gradient_.resize(count);
  for (Eigen::Index d = 0; d < count; ++d) {
    const auto direction = static_cast<std::size_t>(d);
    float weight = ridge;
    float darker = 0;
    for (std::uint32_t k = first_point_[direction]; k < first_point_[direction + 1]; ++k) {
      weight += weights_[hidden_points_[k]];
      darker += darker_[hidden_points_[k]];
    }
    diagonal_[d] = weight;
    gradient_[d] = darker;
  }
  auto shares = shares_.col(channel);
  if (channel != brightness) shares = shares_.col(brightness);
  const auto change_by = [&](Eigen::Index direction, float change) {
    const float* const by = column(static_cast<std::size_t>(direction));
    gradient_ -= change * Eigen::Map<const Eigen::ArrayXf>(by, count);
  };
  for (Eigen::Index d = 0; d < count; ++d) {
    if (shares[d] != 0) change_by(d, shares[d]);
  }
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (Eigen::Index d = 0; d < count; ++d) {
      const float next = std::max(0.F, shares[d] + gradient_[d] / diagonal_[d] - smallest_share);
      const float change = next - shares[d];
      if (change == 0) continue;
      change_by(d, change);
      shares[d] = next;
    }
  }
}

/// Sets the light that is left at each point, from the shares of the brightness.
void ShadowFit::find_light() {
  for (Point& point : points_) point.light = 1;
  for (std::size_t d = 0; d < has_column_.size(); ++d) {
    const float share = shares_(static_cast<Eigen::Index>(d), brightness);
    if (share == 0) continue;
    for (std::uint32_t k = first_point_[d]; k < first_point_[d + 1]; ++k) {
      points_[hidden_points_[k]].light -= share;
    }
  }
  for (Point& point : points_) point.light = std::max(point.light, least_light);
}

bool ShadowFit::explains() {
  float with = 0;
  float without = 0;
  std::size_t in_shadow = 0;
  for (const Point& point : points_) {
    if (point.light > shadow_light) continue;
    const float relative = point.levels[brightness] / point.field;
    with += point.weight * (relative - point.light) * (relative - point.light);
    without += point.weight * (relative - 1) * (relative - 1);
    ++in_shadow;
  }
  if (in_shadow < fewest_in_shadow || !(without > 0)) return false;
  unexplained_ = with / without;
  return unexplained_ < most_unexplained && shares_.col(brightness).sum() <= most_shares;
}

/// A shadow darkens all channels alike: what of the darkness is colour, and what it leaves
/// unexplained, are small together.
bool ShadowFit::is_colorless() const {
  float color = 0;
  float dark = 0;
  for (const Point& point : points_) {
    if (point.light > shadow_light) continue;
    const float mean = point.relative.mean();
    color += point.weight * (point.relative - mean).square().mean();
    dark += point.weight * (mean - 1) * (mean - 1);
  }
  return color < (most_unexplained_or_color - unexplained_) * dark;
}

}  // namespace diminish
