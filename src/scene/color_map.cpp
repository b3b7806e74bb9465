#include "scene/color_map.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/robust.h"

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
  for (int pass = 0; pass < passes; ++pass) {
    weigh(pairs);
    fit_channels(pairs, model);
    if (model == ColorMapModel::field) fit_field(pairs);
  }
  return map_;
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

void ColorMapFit::weigh(const std::vector<ColorPair>& pairs) {
  residuals_.clear();
  for (const ColorPair& pair : pairs) {
    const Eigen::Array3f mapped = map_(pair.rgbd, pair.pixel.x(), pair.pixel.y());
    residuals_.push_back((pair.camera - mapped).matrix().norm());
  }
  values_ = residuals_;
  // Where Tukey's weights become 0: 4.7 standard deviations.
  const float end = 4.7F * std::max(least_scale, 0.65F * median(values_));
  weights_.clear();
  for (const float residual : residuals_) weights_.push_back(tukey_weight(residual, end));
}

/// Fits matrix and offset with the field fixed.
void ColorMapFit::fit_channels(const std::vector<ColorPair>& pairs, ColorMapModel model) {
  Eigen::Matrix4f squares = Eigen::Matrix4f::Zero();
  Eigen::Matrix<float, 4, 3> products = Eigen::Matrix<float, 4, 3>::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const ColorPair& pair = pairs[i];
    const float field = map_.field_at(pair.pixel.x(), pair.pixel.y());
    Eigen::Vector4f terms;
    terms << pair.rgbd.matrix() / unit, 1;
    const Eigen::Vector4f weighted = weights_[i] * terms;
    squares += weighted * terms.transpose();
    products += weighted * (pair.camera.matrix() / (unit * field)).transpose();
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
      solution(used) = own.ldlt().solve(target);
    } else {
      solution = squares.ldlt().solve(products.col(c));
    }
    map_.matrix.row(c) = solution.head<3>();
    map_.offset[c] = unit * solution[3];
  }
}

void ColorMapFit::fit_field(const std::vector<ColorPair>& pairs) {
  Eigen::Matrix<float, 5, 5> squares = Eigen::Matrix<float, 5, 5>::Identity() * prior_pairs;
  Terms products = Terms::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const ColorPair& pair = pairs[i];
    const Terms terms = field_terms(map_, pair.pixel.x(), pair.pixel.y());
    const Eigen::Vector3f flat = (map_.matrix * pair.rgbd.matrix() + map_.offset) / unit;
    const Eigen::Vector3f rest = pair.camera.matrix() / unit - flat;
    squares += (weights_[i] * flat.squaredNorm()) * terms * terms.transpose();
    products += (weights_[i] * flat.dot(rest)) * terms;
  }
  map_.field = squares.ldlt().solve(products);
}

}  // namespace diminish
