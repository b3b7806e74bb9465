#include "pose/pose_refinement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/robust.h"
#include "core/rows.h"
#include "geometry/rotation.h"

namespace diminish {
namespace {

/// What a picture is shrunk to, to blur what is misplaced by a few pixels into one another.
constexpr int small_width = 320;
constexpr int most_iterations = 10;
/// Metres and radians: smaller steps move no pixel by a tenth.
constexpr float last_step = 1e-4F;
constexpr std::size_t fewest_points = 150;
constexpr std::size_t most_points = 2400;

/// What a marker leaves open, and what is taken for a mistake.
constexpr float rotation_deviation = 0.5F * std::numbers::pi_v<float> / 180;
constexpr float translation_deviation_m = 0.012F;
constexpr float largest_deviations = 4;
/// Neighbouring samples' errors are not independent: they count for less than their number.
constexpr float independent_share = 0.1F;

float brightness(int blue, int green, int red) {
  return 0.114F * static_cast<float>(blue) + 0.587F * static_cast<float>(green) +
         0.299F * static_cast<float>(red);
}

RigidTransform exponential(const Eigen::Matrix<double, 6, 1>& twist) {
  return {rotation_by(twist.tail<3>()), twist.head<3>()};
}

}  // namespace

PoseRefinement::PoseRefinement(const Intrinsics& color)
    : color_(color),
      projection_(Lens(color)),
      shrinkage_(std::max(1, (color.width + small_width / 2) / small_width)),
      lines_(256) {}

/// Of the square of pixels that makes one, four are enough: they blur as much.
void PoseRefinement::shrink(const Image<Bgr>& image) {
  small_.resize(image.width() / shrinkage_, image.height() / shrinkage_);
  const int apart = shrinkage_ / 2;
  for_rows(small_.height(), [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const Bgr* upper = image.row(shrinkage_ * y);
      const Bgr* lower = image.row(shrinkage_ * y + apart);
      float* to = small_.row(y);
      for (int x = 0; x < small_.width(); ++x, upper += shrinkage_, lower += shrinkage_) {
        const int blue = upper[0].b + upper[apart].b + lower[0].b + lower[apart].b;
        const int green = upper[0].g + upper[apart].g + lower[0].g + lower[apart].g;
        const int red = upper[0].r + upper[apart].r + lower[0].r + lower[apart].r;
        to[x] = brightness(blue, green, red) / 4;
      }
    }
  });
}

/// The brightness around each sample, over about the area of a pixel of the small picture.
void PoseRefinement::collect(const FrameSet& frame, const std::vector<SceneSample>& samples) {
  constexpr int reach = 2;
  const int spacing = shrinkage_ / 2;
  const int rim = reach * spacing;
  points_.clear();
  const std::size_t step = (samples.size() + most_points - 1) / most_points;
  for (std::size_t i = 0; i < samples.size(); i += step) {
    const SceneSample& sample = samples[i];
    const Image<Bgr>& image = frame.rgbd[sample.source - 1U].color;
    const int u = static_cast<int>(std::lrint(sample.texture.x()));
    const int v = static_cast<int>(std::lrint(sample.texture.y()));
    if (u < rim || v < rim || u >= image.width() - rim || v >= image.height() - rim) continue;
    float sum = 0;
    for (int j = -reach; j <= reach; ++j) {
      for (int k = -reach; k <= reach; ++k) {
        const Bgr& color = image(u + k * spacing, v + j * spacing);
        sum += brightness(color.b, color.g, color.r);
      }
    }
    constexpr float taps = (2 * reach + 1) * (2 * reach + 1);
    points_.push_back({sample.point_m, sum / taps, sample.source});
  }
}

void PoseRefinement::linearise(const RigidTransform& correction, const Mask& occlusion) {
  const Eigen::Matrix3f rotation = correction.rotation.cast<float>();
  const Eigen::Vector3f translation = correction.translation.cast<float>();
  const auto fx = static_cast<float>(color_.fx);
  const auto fy = static_cast<float>(color_.fy);
  const auto shrinkage = static_cast<float>(shrinkage_);
  // Of the four pixels that make one of the small picture.
  const float center = static_cast<float>(shrinkage_ / 2) / 2;
  rows_.clear();
  for (const Point& point : points_) {
    const Eigen::Vector3f p = rotation * point.point_m + translation;
    float px = 0;
    float py = 0;
    if (!(p.z() > 0) || !projection_.distort(p.x() / p.z(), p.y() / p.z(), px, py)) continue;
    const float x = (px - center) / shrinkage;
    const float y = (py - center) / shrinkage;
    if (!(x >= 1 && y >= 1 && x < static_cast<float>(small_.width() - 2) &&
          y < static_cast<float>(small_.height() - 2))) {
      continue;
    }
    const int column = static_cast<int>(x);
    const int row = static_cast<int>(y);
    const int left = shrinkage_ * column;
    const int top = shrinkage_ * row;
    const int beyond = 2 * shrinkage_ - 1;
    if ((occlusion(left, top) | occlusion(left + beyond, top) | occlusion(left, top + beyond) |
         occlusion(left + beyond, top + beyond)) != 0) {
      continue;
    }
    const float u = x - static_cast<float>(column);
    const float v = y - static_cast<float>(row);
    const float* upper = small_.row(row) + column;
    const float* lower = small_.row(row + 1) + column;
    const float seen =
        (1 - v) * ((1 - u) * upper[0] + u * upper[1]) + v * ((1 - u) * lower[0] + u * lower[1]);
    const float du = ((1 - v) * (upper[1] - upper[0]) + v * (lower[1] - lower[0])) / shrinkage;
    const float dv = ((1 - u) * (lower[0] - upper[0]) + u * (lower[1] - upper[1])) / shrinkage;
    // The lens' distortion hardly changes the derivative.
    const Eigen::Vector3f by_point(du * fx / p.z(), dv * fy / p.z(),
                                   -(du * fx * p.x() + dv * fy * p.y()) / (p.z() * p.z()));
    Row next;
    next.derivative.head<3>() = by_point;
    next.derivative.tail<3>() = p.cross(by_point);
    next.brightness = point.brightness;
    next.seen = seen;
    next.source = point.source;
    rows_.push_back(next);
  }
}

void PoseRefinement::fit_lines() {
  struct Sums {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  };
  Sums sums[256];
  for (const Row& row : rows_) {
    Sums& sum = sums[row.source];
    const double weighted = static_cast<double>(row.weight) * static_cast<double>(row.brightness);
    sum.n += static_cast<double>(row.weight);
    sum.x += weighted;
    sum.y += static_cast<double>(row.weight) * static_cast<double>(row.seen);
    sum.xx += weighted * static_cast<double>(row.brightness);
    sum.xy += weighted * static_cast<double>(row.seen);
  }
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const Sums& sum = sums[i];
    const double determinant = sum.n * sum.xx - sum.x * sum.x;
    if (!(determinant > 1)) continue;
    const double gain = (sum.n * sum.xy - sum.x * sum.y) / determinant;
    lines_[i] = {static_cast<float>(gain), static_cast<float>((sum.y - gain * sum.x) / sum.n)};
  }
}

float PoseRefinement::weigh() {
  magnitudes_.clear();
  for (Row& row : rows_) {
    const Line& line = lines_[row.source];
    row.residual = row.seen - line.gain * row.brightness - line.offset;
    magnitudes_.push_back(std::abs(row.residual));
  }
  const float scale = std::max(1.F, 1.48F * median(magnitudes_));
  for (Row& row : rows_) row.weight = tukey_weight(std::abs(row.residual), 4.7F * scale);
  return scale;
}

bool PoseRefinement::refine(const FrameSet& frame, const Mask& occlusion,
                            Reconstruction& reconstruction, Poses& poses) {
  const std::vector<SceneSample>& samples = reconstruction.samples;
  const int smallest_side = 8 * shrinkage_;
  if (std::min(frame.color.width(), frame.color.height()) < smallest_side) return false;
  if (samples.size() < fewest_points) return false;
  shrink(frame.color);
  collect(frame, samples);
  std::fill(lines_.begin(), lines_.end(), Line{});

  Twist prior;
  prior.head<3>().setConstant(1 / (translation_deviation_m * translation_deviation_m));
  prior.tail<3>().setConstant(1 / (rotation_deviation * rotation_deviation));
  RigidTransform correction;
  Twist total = Twist::Zero();
  float first_cost = 0;
  float cost = 0;
  for (int iteration = 0;; ++iteration) {
    linearise(correction, occlusion);
    if (rows_.size() < fewest_points) return false;
    // Later on the lines hardly change.
    const int passes = iteration == 0 ? 3 : 1;
    float scale = 0;
    for (int pass = 0; pass < passes; ++pass) {
      if (iteration > 0) weigh();
      fit_lines();
      scale = weigh();
    }
    Eigen::Matrix<float, 6, 6> squares = Eigen::Matrix<float, 6, 6>::Zero();
    Twist products = Twist::Zero();
    cost = 0;
    for (const Row& row : rows_) {
      squares += (row.weight * row.derivative) * row.derivative.transpose();
      products -= (row.weight * row.residual) * row.derivative;
      // Of one scale, so that iterations compare (Geman & McClure 1985).
      constexpr float same_scale = 400;
      const float squared = row.residual * row.residual;
      cost += squared / (squared + same_scale);
    }
    cost /= static_cast<float>(rows_.size());
    if (iteration == 0) first_cost = cost;
    if (iteration == most_iterations) break;
    const Twist held = prior * (scale * scale / independent_share);
    squares.diagonal() += held;
    products -= held.cwiseProduct(total);
    const Twist step = squares.ldlt().solve(products);
    if (step.cwiseAbs().maxCoeff() < last_step) break;
    total += step;
    correction = exponential(step.cast<double>()) * correction;
  }
  if (!(cost < first_cost) ||
      total.head<3>().norm() > largest_deviations * translation_deviation_m ||
      total.tail<3>().norm() > largest_deviations * rotation_deviation) {
    return false;
  }
  apply(correction, reconstruction, poses);
  return true;
}

void PoseRefinement::apply(const RigidTransform& correction, Reconstruction& reconstruction,
                           Poses& poses) const {
  for (auto& pose : poses.color_from_depth) {
    if (pose) pose = correction * *pose;
  }
  if (poses.color_from_world) poses.color_from_world = correction * *poses.color_from_world;
  const Eigen::Matrix3f rotation = correction.rotation.cast<float>();
  const Eigen::Vector3f translation = correction.translation.cast<float>();
  for (Eigen::Vector3f& point_m : reconstruction.object_points_m) {
    point_m = rotation * point_m + translation;
  }
  for (SceneSample& sample : reconstruction.samples) {
    const Eigen::Vector3f p = rotation * sample.point_m + translation;
    sample.point_m = p;
    if (!(p.z() > 0) ||
        !projection_.distort(p.x() / p.z(), p.y() / p.z(), sample.pixel.x(), sample.pixel.y())) {
      sample.pixel.setConstant(-1);
    }
  }
}

}  // namespace diminish
