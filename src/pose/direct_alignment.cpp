#include "pose/direct_alignment.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/median_of_magnitudes.h"
#include "core/tasks.h"
#include "diminish/remote_images.h"
#include "pose/neighbourhood_brightness.h"

namespace diminish {
namespace {

constexpr float nearest_m = 1e-3F;
constexpr std::size_t fewest_seen = 150;
/// Neighbouring samples' errors are not independent: they count for less than their number.
constexpr float independent_share = 0.1F;

RigidTransform exponential(const Eigen::Matrix<double, 6, 1>& twist) {
  return {rotation_by(twist.tail<3>()), twist.head<3>()};
}

/// Less than 0 if it is not known.
float brightness_at(const SceneSample& sample, const RgbdFrame& images, int spacing_px) {
  if (!images.is_remote()) {
    return neighbourhood_brightness(images.color, sample.texture.x(), sample.texture.y(),
                                    spacing_px);
  }
  const Glance& glance = images.remote->glance();
  const auto found = std::find(glance.spacings_px.begin(), glance.spacings_px.end(), spacing_px);
  if (found == glance.spacings_px.end()) return -1;
  return glance.points[sample.point]
      .brightness[static_cast<std::size_t>(found - glance.spacings_px.begin())];
}

}  // namespace

bool DirectAlignment::begin(const FrameSet& frame, const Mask& occlusion,
                            const SceneSamples& scene) {
  const int smallest_side = 8 * level_.shrinkage;
  if (std::min(frame.color.width(), frame.color.height()) < smallest_side) return false;
  small_.begin(frame.color, occlusion, level_.shrinkage);
  collect(frame, scene.surfaces);
  lines_.assign(most_sources, Line{});
  return true;
}

/// The brightness around each sample that may be in the picture, over about the area of a pixel of
/// the small one.
void DirectAlignment::collect(const FrameSet& frame, const std::vector<SceneSample>& samples) {
  const int spacing_px = level_.spacing_px();
  const Rect picture = frame.color.bounds();
  points_.clear();
  const std::size_t step = (samples.size() + level_.most_points - 1) / level_.most_points;
  for (std::size_t i = 0; i < samples.size(); i += step) {
    const SceneSample& sample = samples[i];
    if (!picture.contains(static_cast<int>(sample.pixel.x()), static_cast<int>(sample.pixel.y()))) {
      continue;
    }
    const float brightness = brightness_at(sample, frame.rgbd[sample.source - 1U], spacing_px);
    if (brightness >= 0) add(sample.point_m, brightness, sample.source);
  }
}

void DirectAlignment::add(const Eigen::Vector3f& point_m, float brightness, std::uint8_t source) {
  if (points_.empty() || points_.back().count == lanes || points_.back().source != source) {
    // What is left over is never seen.
    Points& points = points_.emplace_back();
    points.x_m = points.y_m = points.z_m = points.brightness = Lanes::Zero();
    points.source = source;
    points.count = 0;
  }
  Points& points = points_.back();
  const int i = points.count++;
  points.x_m[i] = point_m.x();
  points.y_m[i] = point_m.y();
  points.z_m[i] = point_m.z();
  points.brightness[i] = brightness;
}

std::size_t DirectAlignment::linearise(const RigidTransform& correction) {
  const Eigen::Matrix3f r = correction.rotation.cast<float>();
  const Eigen::Vector3f t = correction.translation.cast<float>();
  const Projection& lens = projection_;
  const float scale = 1 / static_cast<float>(level_.shrinkage);
  // Of the four pixels that make one of the small picture.
  const int half = level_.shrinkage / 2;
  const float center = static_cast<float>(half) / 2;
  const auto last_column = static_cast<float>(small_.width() - 2);
  const auto last_row = static_cast<float>(small_.height() - 2);
  const auto linearise_some = [&](Points& points) {
    std::size_t count = 0;
    const auto coordinate = [&](int i) {
      return r(i, 0) * points.x_m + r(i, 1) * points.y_m + r(i, 2) * points.z_m + t[i];
    };
    const Lanes px = coordinate(0);
    const Lanes py = coordinate(1);
    const Lanes pz = coordinate(2).max(nearest_m);
    const Lanes inverse_z = 1 / pz;
    const Lanes x = px * inverse_z;
    const Lanes y = py * inverse_z;
    const Lanes r2 = x * x + y * y;
    Lanes distorted_x;
    Lanes distorted_y;
    with_lens_model(lens.model, [&](auto model) {
      plain::distort_ray<decltype(model)::value>(
          lens.distortion, [](float value) { return value; }, x, y, r2, distorted_x, distorted_y);
    });
    const Lanes column = (lens.fx * distorted_x + lens.cx - center) * scale;
    const Lanes row = (lens.fy * distorted_y + lens.cy - center) * scale;
    Lanes dx = Lanes::Zero();
    Lanes dy = Lanes::Zero();
    points.seen.setZero();
    points.is_seen.setZero();
    for (int i = 0; i < points.count; ++i) {
      if (!(pz[i] > nearest_m && r2[i] < lens.max_radius_squared && column[i] >= 1 && row[i] >= 1 &&
            column[i] < last_column && row[i] < last_row)) {
        continue;
      }
      ShrunkPicture::Brightness found;
      if (!small_.look_up(column[i], row[i], found)) continue;
      points.seen[i] = found.level;
      points.is_seen[i] = 1;
      dx[i] = found.dx;
      dy[i] = found.dy;
      ++count;
    }
    // The lens' distortion hardly changes the derivative.
    const Lanes u = dx * inverse_z * (scale * lens.fx);
    const Lanes v = dy * inverse_z * (scale * lens.fy);
    const Lanes w = -(u * x + v * y);
    points.derivative = {u, v, w, py * w - pz * v, pz * u - px * w, px * v - py * u};
    return count;
  };
  constexpr std::size_t most_tasks = 8;
  constexpr std::size_t least_in_task = 100;  // fewer are linearised sooner by one thread
  const std::size_t tasks = std::clamp<std::size_t>(points_.size() / least_in_task, 1, most_tasks);
  std::array<std::size_t, most_tasks> counts{};
  for_tasks(tasks, [&](std::size_t task) {
    for (std::size_t i = task * points_.size() / tasks; i < (task + 1) * points_.size() / tasks;
         ++i) {
      counts[task] += linearise_some(points_[i]);
    }
  });
  return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

void DirectAlignment::fit_lines() {
  using Sum = Eigen::Array<double, lanes, 1>;
  for (auto points = points_.begin(); points != points_.end();) {
    const std::uint8_t source = points->source;
    Sum n = Sum::Zero();
    Sum x = Sum::Zero();
    Sum y = Sum::Zero();
    Sum xx = Sum::Zero();
    Sum xy = Sum::Zero();
    for (; points != points_.end() && points->source == source; ++points) {
      const Sum weight = points->weight.cast<double>();
      const Sum brightness = points->brightness.cast<double>();
      const Sum seen = points->seen.cast<double>();
      const Sum weighted = weight * brightness;
      n += weight;
      x += weighted;
      y += weight * seen;
      xx += weighted * brightness;
      xy += weighted * seen;
    }
    const double determinant = n.sum() * xx.sum() - x.sum() * x.sum();
    if (!(determinant > 1)) continue;
    const double gain = (n.sum() * xy.sum() - x.sum() * y.sum()) / determinant;
    lines_[source] = {static_cast<float>(gain),
                      static_cast<float>((y.sum() - gain * x.sum()) / n.sum())};
  }
}

void DirectAlignment::find_residuals() {
  for (Points& points : points_) {
    const Line& line = lines_[points.source];
    points.residual = points.is_seen * (points.seen - line.gain * points.brightness - line.offset);
  }
}

float DirectAlignment::find_scale() {
  magnitudes_.resize(lanes * points_.size());
  std::size_t count = 0;
  for (const Points& points : points_) {
    for (int i = 0; i < lanes; ++i) {
      magnitudes_[count] = std::abs(points.residual[i]);
      count += points.is_seen[i] != 0 ? 1 : 0;
    }
  }
  magnitudes_.resize(count);
  return std::max(1.F, 1.48F * median_of_magnitudes(magnitudes_));
}

/// As tukey_weight does.
void DirectAlignment::weigh(float scale) {
  const float end = 4.7F * scale;
  for (Points& points : points_) {
    const Lanes relative = (points.residual.abs() / end).min(1.F);
    points.weight = points.is_seen * (1 - relative.square()).square();
  }
}

DirectAlignment::Equations DirectAlignment::add_up() const {
  std::array<Lanes, 21> squares;
  std::array<Lanes, 6> products;
  squares.fill(Lanes::Zero());
  products.fill(Lanes::Zero());
  for (const Points& points : points_) {
    auto square = squares.begin();
    for (std::size_t i = 0; i < 6; ++i) {
      const Lanes weighted = points.weight * points.derivative[i];
      products[i] -= weighted * points.residual;
      for (std::size_t j = 0; j <= i; ++j) *square++ += weighted * points.derivative[j];
    }
  }
  Equations sums;
  auto square = squares.begin();
  for (Eigen::Index i = 0; i < 6; ++i) {
    sums.products[i] = products[static_cast<std::size_t>(i)].sum();
    for (Eigen::Index j = 0; j <= i; ++j) {
      sums.squares(i, j) = sums.squares(j, i) = (square++)->sum();
    }
  }
  return sums;
}

/// The sum over all points. Of one scale, so that iterations compare (Geman & McClure 1985).
float DirectAlignment::cost() const {
  constexpr float same_scale = 400;
  Lanes sum = Lanes::Zero();
  for (const Points& points : points_) {
    const Lanes squared = points.residual.square();
    sum += squared / (squared + same_scale);
  }
  return sum.sum();
}

DirectAlignment::Twist DirectAlignment::further(const Twist& step, const Twist& last) {
  const float squared = last.squaredNorm();
  if (!(squared > 0)) return step;
  const float ratio = step.dot(last) / squared;
  constexpr float most = 0.8F;
  return step / (1 - std::clamp(ratio, 0.F, most));
}

bool DirectAlignment::iterate(int iterations, Estimate& estimate) {
  const Twist prior = (1 / deviations_.array().square()).matrix();
  Twist last = Twist::Zero();
  float scale = 0;
  for (int iteration = 0;; ++iteration) {
    const std::size_t seen = linearise(estimate.correction);
    if (seen < fewest_seen) return false;
    if (iteration == 0) {
      for (Points& points : points_) points.weight = points.is_seen;
    } else {
      find_residuals();
      weigh(scale);
    }
    // Later on the lines hardly change.
    const int passes = iteration == 0 ? 3 : 1;
    for (int pass = 0; pass < passes; ++pass) {
      fit_lines();
      find_residuals();
      scale = find_scale();
      weigh(scale);
    }
    estimate.cost = cost() / static_cast<float>(seen);
    if (iteration == iterations) return true;
    Equations equations = add_up();
    const Twist held = prior * (scale * scale / independent_share);
    equations.squares.diagonal() += held;
    equations.products -= held.cwiseProduct(estimate.twist);
    Twist step = equations.solve();
    if (level_.extrapolates) step = further(step, last);
    if (step.cwiseAbs().maxCoeff() < level_.last_step) return true;
    last = step;
    estimate.twist += step;
    estimate.correction = exponential(step.cast<double>()) * estimate.correction;
  }
}

}  // namespace diminish
