#include "pose/pose_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/rows.h"

namespace diminish {
namespace {

constexpr int shrinkage = 4;
constexpr int iterations = 10;
constexpr std::size_t fewest_points = 150;
/// What a marker leaves open, and what is taken for a mistake.
constexpr double rotation_deviation = 0.5 * std::numbers::pi / 180;
constexpr double translation_deviation_m = 0.012;
constexpr double largest_deviations = 4;
/// Neighbouring samples' errors are not independent: they count for less than their number.
constexpr double independent_share = 0.1;

float brightness(const Bgr& color) {
  return 0.114F * static_cast<float>(color.b) + 0.587F * static_cast<float>(color.g) +
         0.299F * static_cast<float>(color.r);
}

RigidTransform exponential(const Eigen::Matrix<double, 6, 1>& twist) {
  const Eigen::Vector3d axis = twist.tail<3>();
  const double angle = axis.norm();
  RigidTransform result;
  if (angle > 0) result.rotation = Eigen::AngleAxisd(angle, axis / angle).toRotationMatrix();
  result.translation = twist.head<3>();
  return result;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

PoseRefinement::PoseRefinement(const Intrinsics& color) : lens_(color) {}

void PoseRefinement::shrink(const Image<Bgr>& image) {
  small_.resize(image.width() / shrinkage, image.height() / shrinkage);
  for_rows(small_.height(), [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      float* to = small_.row(y);
      for (int x = 0; x < small_.width(); ++x) {
        unsigned blue = 0;
        unsigned green = 0;
        unsigned red = 0;
        for (int dy = 0; dy < shrinkage; ++dy) {
          const Bgr* from = image.row(shrinkage * y + dy) + std::ptrdiff_t{shrinkage} * x;
          for (int dx = 0; dx < shrinkage; ++dx) {
            blue += from[dx].b;
            green += from[dx].g;
            red += from[dx].r;
          }
        }
        to[x] = (0.114F * static_cast<float>(blue) + 0.587F * static_cast<float>(green) +
                 0.299F * static_cast<float>(red)) /
                (shrinkage * shrinkage);
      }
    }
  });
}

void PoseRefinement::collect(const FrameSet& frame, const std::vector<SceneSample>& samples) {
  constexpr int reach = 2;
  constexpr int spacing = 2;
  points_.clear();
  for (const SceneSample& sample : samples) {
    const Image<Bgr>& image = frame.rgbd[sample.source - 1U].color;
    const int u = static_cast<int>(std::lrint(sample.texture.x()));
    const int v = static_cast<int>(std::lrint(sample.texture.y()));
    constexpr int rim = reach * spacing;
    if (u < rim || v < rim || u >= image.width() - rim || v >= image.height() - rim) continue;
    float sum = 0;
    for (int dy = -rim; dy <= rim; dy += spacing) {
      for (int dx = -rim; dx <= rim; dx += spacing) sum += brightness(image(u + dx, v + dy));
    }
    constexpr float taps = (2 * reach + 1) * (2 * reach + 1);
    points_.push_back({sample.point_m, sum / taps, sample.source});
  }
}

bool PoseRefinement::refine(const FrameSet& frame, const Mask& occlusion,
                            std::vector<SceneSample>& samples, Poses& poses) {
  if (frame.color.width() < 8 * shrinkage || frame.color.height() < 8 * shrinkage) return false;
  shrink(frame.color);
  collect(frame, samples);
  if (points_.size() < fewest_points) return false;

  struct Row {
    Pose derivative;
    double brightness, seen;
    std::uint8_t source;
  };
  std::vector<Row> rows;
  std::vector<double> residuals, magnitudes;
  std::vector<double> gains(256, 1.0), offsets(256, 0.0);
  RigidTransform correction;
  const Intrinsics& camera = lens_.intrinsics();
  double first_cost = 0;
  double last_cost = 0;
  Pose total = Pose::Zero();
  for (int iteration = 0; iteration <= iterations; ++iteration) {
    rows.clear();
    for (const Point& point : points_) {
      const Eigen::Vector3d p = correction * point.point_m.cast<double>();
      const auto pixel = lens_.project(p);
      if (!pixel) continue;
      const double x = (pixel->x() + 0.5) / shrinkage - 0.5;
      const double y = (pixel->y() + 0.5) / shrinkage - 0.5;
      if (!(x >= 1 && y >= 1 && x < small_.width() - 2 && y < small_.height() - 2)) continue;
      const int column = static_cast<int>(x);
      const int row = static_cast<int>(y);
      constexpr int half = shrinkage;
      const int px = static_cast<int>(pixel->x());
      const int py = static_cast<int>(pixel->y());
      const Rect& bounds = occlusion.bounds();
      if (occlusion(px, py) != 0 || occlusion(std::max(px - half, 0), py) != 0 ||
          occlusion(std::min(px + half, bounds.width - 1), py) != 0 ||
          occlusion(px, std::max(py - half, 0)) != 0 ||
          occlusion(px, std::min(py + half, bounds.height - 1)) != 0) {
        continue;
      }
      const double u = x - column;
      const double v = y - row;
      const double a = small_(column, row);
      const double b = small_(column + 1, row);
      const double c = small_(column, row + 1);
      const double d = small_(column + 1, row + 1);
      const double value = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
      const double du = ((1 - v) * (b - a) + v * (d - c)) / shrinkage;
      const double dv = ((1 - u) * (c - a) + u * (d - b)) / shrinkage;
      // The lens' distortion hardly changes the derivative.
      const Eigen::Vector3d by_point(du * camera.fx / p.z(), dv * camera.fy / p.z(),
                                     -(du * camera.fx * p.x() + dv * camera.fy * p.y()) /
                                         (p.z() * p.z()));
      Row next;
      next.derivative << by_point, p.cross(by_point);
      next.brightness = point.brightness;
      next.seen = value;
      next.source = point.source;
      rows.push_back(next);
    }
    if (rows.size() < fewest_points) return false;
    // Gain and offset of each camera: robustly, by the residuals as they were.
    double scale = 0;
    std::vector<double> weights(rows.size(), 1.0);
    for (int pass = 0; pass < 3; ++pass) {
      double n[256] = {}, sx[256] = {}, sy[256] = {}, sxx[256] = {}, sxy[256] = {};
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::size_t s = rows[i].source;
        n[s] += weights[i];
        sx[s] += weights[i] * rows[i].brightness;
        sy[s] += weights[i] * rows[i].seen;
        sxx[s] += weights[i] * rows[i].brightness * rows[i].brightness;
        sxy[s] += weights[i] * rows[i].brightness * rows[i].seen;
      }
      for (std::size_t s = 0; s < 256; ++s) {
        const double determinant = n[s] * sxx[s] - sx[s] * sx[s];
        if (!(determinant > 1)) continue;
        gains[s] = (n[s] * sxy[s] - sx[s] * sy[s]) / determinant;
        offsets[s] = (sy[s] - gains[s] * sx[s]) / n[s];
      }
      residuals.clear();
      magnitudes.clear();
      for (const Row& row : rows) {
        residuals.push_back(row.seen - gains[row.source] * row.brightness - offsets[row.source]);
        magnitudes.push_back(std::abs(residuals.back()));
      }
      scale = std::max(1.0, 1.48 * median(magnitudes));
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const double q = std::min(1.0, std::abs(residuals[i]) / (4.7 * scale));
        weights[i] = (1 - q * q) * (1 - q * q);
      }
    }
    Eigen::Matrix<double, 6, 6> squares = Eigen::Matrix<double, 6, 6>::Zero();
    Pose products = Pose::Zero();
    double cost = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      squares += weights[i] * rows[i].derivative * rows[i].derivative.transpose();
      products -= weights[i] * residuals[i] * rows[i].derivative;
      // The robust cost, of a fixed scale, so that iterations compare.
      const double r = residuals[i] * residuals[i];
      cost += r / (r + 400);
    }
    cost /= static_cast<double>(rows.size());
    if (iteration == 0) first_cost = cost;
    last_cost = cost;
    if (iteration == iterations) break;
    Pose prior;
    prior << Eigen::Vector3d::Constant(1 / (translation_deviation_m * translation_deviation_m)),
        Eigen::Vector3d::Constant(1 / (rotation_deviation * rotation_deviation));
    prior *= scale * scale / independent_share;
    squares.diagonal() += prior;
    products -= prior.cwiseProduct(total);
    const Pose step = squares.ldlt().solve(products);
    total += step;
    correction = exponential(step) * correction;
    if (step.head<3>().norm() < 2e-5 && step.tail<3>().norm() < 2e-5) break;
  }
  if (getenv("DBG"))
    printf("refine: %zu points, cost %.4f -> %.4f, moved %.1f mm %.2f deg\n", rows.size(), first_cost,
           last_cost, 1000 * total.head<3>().norm(), total.tail<3>().norm() * 57.3);
  if (!(last_cost < first_cost) ||
      total.head<3>().norm() > largest_deviations * translation_deviation_m ||
      total.tail<3>().norm() > largest_deviations * rotation_deviation) {
    return false;
  }
  for (auto& pose : poses.color_from_depth) {
    if (pose) pose = correction * *pose;
  }
  if (poses.color_from_world) poses.color_from_world = correction * *poses.color_from_world;
  for (SceneSample& sample : samples) {
    const Eigen::Vector3d p = correction * sample.point_m.cast<double>();
    const auto pixel = lens_.project(p);
    sample.point_m = p.cast<float>();
    sample.pixel = pixel ? Eigen::Vector2f(pixel->cast<float>()) : Eigen::Vector2f(-1e6F, -1e6F);
  }
  return true;
}

}  // namespace diminish
