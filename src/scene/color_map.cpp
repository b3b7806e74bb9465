#include "scene/color_map.h"

#include <algorithm>

#include "core/median_of_magnitudes.h"
#include "core/robust.h"
#include "geometry/symmetric_solver.h"

namespace diminish {
namespace {

using Terms = Eigen::Matrix<float, 5, 1>;

constexpr int passes = 12;
/// Levels; residuals below this are noise.
constexpr float least_scale = 1.5F;
/// The weight of the prior, in pairs.
constexpr float prior_pairs = 4;
/// The scale of colours during the fit, in levels.
constexpr float unit = 128;

Terms field_terms(const ColorMap& map, float x, float y) {
  const float u = (x - map.center.x()) / map.half_width;
  const float v = (y - map.center.y()) / map.half_width;
  Terms terms;
  terms << u, v, u * u, u * v, v * v;
  return terms;
}

}  // namespace

float ColorMap::field_at(float x, float y) const {
  return std::clamp(1 + field.dot(field_terms(*this, x, y)), least_field, greatest_field);
}

Eigen::Array3f ColorMap::operator()(const Eigen::Array3f& rgbd, float x, float y) const {
  return field_at(x, y) * (matrix * rgbd.matrix() + offset).array();
}

ColorMap ColorMapFit::fit(const std::vector<ColorPair>& pairs, ColorMapModel model,
                          const Rect& bounds) {
  map_ = {};
  map_.half_width = static_cast<float>(bounds.width) / 2;
  map_.center = {static_cast<float>(bounds.width - 1) / 2,
                 static_cast<float>(bounds.height - 1) / 2};
  gains_.setOnes();
  if (pairs.empty()) return map_;
  start_with_gains(pairs);
  collect(pairs);
  for (int pass = 0; pass < passes; ++pass) {
    weigh();
    fit_channels(model);
    if (model == ColorMapModel::field) fit_field();
  }
  return map_;
}

void ColorMapFit::collect(const std::vector<ColorPair>& pairs) {
  pairs_.clear();
  for (const ColorPair& pair : pairs) {
    if (pairs_.empty() || pairs_.back().count == lanes) {
      Pairs& next = pairs_.emplace_back();
      next.rgbd.fill(Lanes::Zero());
      next.camera.fill(Lanes::Zero());
      next.terms.fill(Lanes::Zero());
      next.weight.setZero();
      next.count = 0;
    }
    Pairs& some = pairs_.back();
    const int i = some.count++;
    const Terms terms = field_terms(map_, pair.pixel.x(), pair.pixel.y());
    for (std::size_t k = 0; k < some.terms.size(); ++k) {
      some.terms[k][i] = terms[static_cast<Eigen::Index>(k)];
    }
    for (std::size_t c = 0; c < 3; ++c) {
      some.rgbd[c][i] = pair.rgbd[static_cast<Eigen::Index>(c)];
      some.camera[c][i] = pair.camera[static_cast<Eigen::Index>(c)];
    }
  }
}

void ColorMapFit::start_with_gains(const std::vector<ColorPair>& pairs) {
  for (int c = 0; c < 3; ++c) {
    values_.clear();
    for (const ColorPair& pair : pairs) {
      values_.push_back(pair.camera[c] / std::max(pair.rgbd[c], 1.F));
    }
    gains_[c] = median(values_);
  }
  map_.matrix = gains_.asDiagonal();
}

ColorMapFit::Lanes ColorMapFit::field_of(const Pairs& pairs) const {
  Lanes field = Lanes::Ones();
  for (std::size_t k = 0; k < pairs.terms.size(); ++k) {
    field += map_.field[static_cast<Eigen::Index>(k)] * pairs.terms[k];
  }
  return field.max(ColorMap::least_field).min(ColorMap::greatest_field);
}

ColorMapFit::Lanes ColorMapFit::flat(const Pairs& pairs, int channel) const {
  const auto row = map_.matrix.row(channel);
  return row[0] * pairs.rgbd[0] + row[1] * pairs.rgbd[1] + row[2] * pairs.rgbd[2] +
         map_.offset[channel];
}

void ColorMapFit::weigh() {
  values_.clear();
  for (Pairs& pairs : pairs_) {
    const Lanes field = field_of(pairs);
    Lanes squares = Lanes::Zero();
    for (int c = 0; c < 3; ++c) {
      squares += (pairs.camera[static_cast<std::size_t>(c)] - field * flat(pairs, c)).square();
    }
    pairs.residual = squares.sqrt();
    values_.insert(values_.end(), pairs.residual.data(), pairs.residual.data() + pairs.count);
  }
  // Where Tukey's weights become 0: 4.7 standard deviations.
  const float end = 4.7F * std::max(least_scale, 0.65F * median_of_magnitudes(values_));
  for (Pairs& pairs : pairs_) {
    const Lanes relative = (pairs.residual / end).min(1.F);
    pairs.weight = (1 - relative.square()).square();
    pairs.weight.tail(lanes - pairs.count).setZero();
  }
}

/// Fits matrix and offset with the field fixed.
void ColorMapFit::fit_channels(ColorMapModel model) {
  // Sums over pairs: the lower half of `squares`, row by row, and `products`, column by column.
  std::array<Lanes, 10> square_sums;
  std::array<Lanes, 12> product_sums;
  square_sums.fill(Lanes::Zero());
  product_sums.fill(Lanes::Zero());
  for (const Pairs& pairs : pairs_) {
    const Lanes inverse_field = 1 / (unit * field_of(pairs));
    std::array<Lanes, 4> terms;
    for (std::size_t c = 0; c < 3; ++c) terms[c] = pairs.rgbd[c] / unit;
    terms[3].setOnes();
    auto square = square_sums.begin();
    for (std::size_t i = 0; i < 4; ++i) {
      const Lanes weighted = pairs.weight * terms[i];
      for (std::size_t j = 0; j <= i; ++j) *square++ += weighted * terms[j];
      for (std::size_t c = 0; c < 3; ++c) {
        product_sums[4 * c + i] += weighted * (pairs.camera[c] * inverse_field);
      }
    }
  }
  Eigen::Matrix4f squares;
  Eigen::Matrix<float, 4, 3> products;
  auto square = square_sums.begin();
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j <= i; ++j) squares(i, j) = squares(j, i) = (square++)->sum();
    for (int c = 0; c < 3; ++c) {
      products(i, c) =
          product_sums[4 * static_cast<std::size_t>(c) + static_cast<std::size_t>(i)].sum();
    }
  }
  constexpr float prior = prior_pairs / 16;
  squares.diagonal().array() += prior;
  for (int c = 0; c < 3; ++c) {
    products(c, c) += prior * gains_[c];
    Eigen::Vector4f solution = Eigen::Vector4f::Zero();
    if (model == ColorMapModel::affine) {
      const Eigen::Array2i used(c, 3);
      const Eigen::Matrix2f own = squares(used, used);
      const Eigen::Vector2f target = products(used, c);
      solution(used) = solve_symmetric(own, target);
    } else {
      solution = solve_symmetric<float, 4>(squares, products.col(c));
    }
    map_.matrix.row(c) = solution.head<3>();
    map_.offset[c] = unit * solution[3];
  }
}

void ColorMapFit::fit_field() {
  std::array<Lanes, 15> square_sums;  // the lower half, row by row
  std::array<Lanes, 5> product_sums;
  square_sums.fill(Lanes::Zero());
  product_sums.fill(Lanes::Zero());
  for (const Pairs& pairs : pairs_) {
    Lanes norm = Lanes::Zero();
    Lanes product = Lanes::Zero();
    for (int c = 0; c < 3; ++c) {
      const Lanes own = flat(pairs, c) / unit;
      norm += own.square();
      product += own * (pairs.camera[static_cast<std::size_t>(c)] / unit - own);
    }
    const Lanes weight = pairs.weight * norm;
    const Lanes weighted_product = pairs.weight * product;
    auto square = square_sums.begin();
    for (std::size_t i = 0; i < pairs.terms.size(); ++i) {
      const Lanes weighted = weight * pairs.terms[i];
      for (std::size_t j = 0; j <= i; ++j) *square++ += weighted * pairs.terms[j];
      product_sums[i] += weighted_product * pairs.terms[i];
    }
  }
  Eigen::Matrix<float, 5, 5> squares;
  Terms products;
  auto square = square_sums.begin();
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j <= i; ++j) squares(i, j) = squares(j, i) = (square++)->sum();
    products[i] = product_sums[static_cast<std::size_t>(i)].sum();
  }
  squares.diagonal().array() += prior_pairs;
  map_.field = solve_symmetric(squares, products);
}

}  // namespace diminish
