#include "setup/calibrate/depth_alignment.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/robust.h"
#include "geometry/rigid_least_squares.h"

namespace diminish {
namespace {

constexpr std::size_t most_planes = 400;
constexpr double most_points_a_side = 20;
constexpr std::size_t least_points = 12;
/// The share of a target that is used: at its rim, depth mixes with what is behind.
constexpr double inner_share = 0.85;
/// Depth further from a plane than this share of the target's distance belongs to something else.
constexpr double largest_distance = 0.1;

using Matrix6d = Eigen::Matrix<double, 6, 6>;

}  // namespace

/// One target: the distances of its points to its plane, linearised.
struct DepthAlignment::Row {
  Eigen::Vector3d centre_m;  ///< of the points, in the colour frame
  double distance_m = 0;     ///< mean
  double spread_m = 0;       ///< mean absolute
  /// Means over the points; rotation about the colour frame's origin.
  NormalEquations<double> equations;
};

DepthAlignment::DepthAlignment(const Lens& depth_lens, double depth_unit_m,
                               const RigidTransform& color_from_depth)
    : depth_lens_(depth_lens), depth_unit_m_(depth_unit_m), color_from_depth_(color_from_depth) {}

void DepthAlignment::add(const TargetView& in_color, ImageView<std::uint16_t> depth) {
  if (planes_.size() == most_planes) return;
  Plane plane{in_color.camera_from_target,
              in_color.alternative,
              in_color.doubtful,
              in_color.low,
              in_color.high,
              {}};
  // Half as large again, because the sensors may not be where the rig says.
  const RigidTransform depth_from_target = color_from_depth_.inverse() * plane.color_from_target;
  const Eigen::Vector2d middle = (plane.low + plane.high) / 2;
  Rect part;
  for (const double x : {-0.75, 0.75}) {
    for (const double y : {-0.75, 0.75}) {
      const Eigen::Vector2d corner =
          middle + Eigen::Vector2d(x, y).cwiseProduct(plane.high - plane.low);
      const auto pixel =
          depth_lens_.project(depth_from_target * Eigen::Vector3d(corner.x(), corner.y(), 0));
      if (!pixel) return;
      extend(part, static_cast<int>(std::lround(pixel->x())),
             static_cast<int>(std::lround(pixel->y())));
    }
  }
  part = intersect(part, depth.bounds());
  const int step = std::max(
      1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(part.width) * part.height) /
                                    (1.5 * most_points_a_side))));
  for (int y = part.y; y < part.bottom(); y += step) {
    for (int x = part.x; x < part.right(); x += step) {
      if (depth(x, y) == 0) continue;
      const double z = depth(x, y) * depth_unit_m_;
      plane.points_m.emplace_back(z * depth_lens_.undistort(Eigen::Vector2d(x, y)).homogeneous());
    }
  }
  Row row;
  if (fit(plane, color_from_depth_, row)) planes_.push_back(std::move(plane));
}

bool DepthAlignment::fit(const Plane& plane, const RigidTransform& color_from_depth, Row& row) {
  bool any = false;
  for (const bool other : {false, true}) {
    if (other && !plane.doubtful) break;
    const RigidTransform& color_from_target = other ? plane.alternative : plane.color_from_target;
    const RigidTransform target_from_color = color_from_target.inverse();
    const Eigen::Vector3d normal = color_from_target.rotation.col(2);
    const Eigen::Vector2d middle = (plane.low + plane.high) / 2;
    const Eigen::Vector2d half = inner_share * (plane.high - plane.low) / 2;
    const double end = largest_distance * color_from_target.translation.norm();
    Row candidate;
    candidate.centre_m.setZero();
    NormalEquations<double> sums;
    std::size_t count = 0;
    for (const Eigen::Vector3d& point : plane.points_m) {
      const Eigen::Vector3d in_color = color_from_depth * point;
      const Eigen::Vector3d on_target = target_from_color * in_color;
      const Eigen::Vector2d off = (on_target.head<2>() - middle).cwiseAbs();
      if (off.x() > half.x() || off.y() > half.y() || std::abs(on_target.z()) > end) continue;
      Eigen::Matrix<double, 1, 6> derivative;
      derivative << in_color.cross(normal).transpose(), normal.transpose();
      sums.add<1>(derivative, Eigen::Matrix<double, 1, 1>(-on_target.z()));
      candidate.distance_m += on_target.z();
      candidate.spread_m += std::abs(on_target.z());
      candidate.centre_m += in_color;
      ++count;
    }
    if (count < least_points) continue;
    const double share = 1 / static_cast<double>(count);
    candidate.equations.add(sums, share);
    candidate.distance_m *= share;
    candidate.spread_m *= share;
    candidate.centre_m *= share;
    if (any && candidate.spread_m > row.spread_m) continue;
    row = candidate;
    any = true;
  }
  return any;
}

std::vector<DepthAlignment::Row> DepthAlignment::rows(
    const RigidTransform& color_from_depth) const {
  std::vector<Row> all;
  for (const Plane& plane : planes_) {
    Row row;
    if (fit(plane, color_from_depth, row)) all.push_back(row);
  }
  return all;
}

namespace {

double root_mean_square(const std::vector<double>& values) {
  double squares = 0;
  for (const double value : values) squares += value * value;
  return values.empty() ? 0 : std::sqrt(squares / static_cast<double>(values.size()));
}

std::string direction_name(const Motion& direction) {
  constexpr const char* names[] = {"rotation about x", "rotation about y", "rotation about z",
                                   "shift along x",    "shift along y",    "shift along z"};
  Eigen::Index largest = 0;
  direction.cwiseAbs().maxCoeff(&largest);
  return names[largest];
}

}  // namespace

DepthAlignment::Result DepthAlignment::solve() const {
  Result result{color_from_depth_, 0, 0, 0, {}, 0};
  const auto distances = [](const std::vector<Row>& rows) {
    std::vector<double> all;
    for (const Row& row : rows) all.push_back(row.distance_m);
    return all;
  };
  std::vector<Row> current = rows(color_from_depth_);
  result.error_before_m = root_mean_square(distances(current));
  constexpr int steps = 30;
  for (int step = 0; step < steps && !current.empty(); ++step) {
    // Each target has about the same weight: a pose's error is common to all of its points.
    std::vector<double> magnitudes;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Row& row : current) {
      magnitudes.push_back(row.spread_m);
      centre += row.centre_m / static_cast<double>(current.size());
    }
    const double scale = std::max(1.5 * median(magnitudes), 1e-4);
    double arm = 0;
    for (const Row& row : current) {
      arm += (row.centre_m - centre).squaredNorm() / static_cast<double>(current.size());
    }
    arm = std::max(std::sqrt(arm), 0.1);
    // Rotation about the targets' centre, in metres at their distance from it, so that all six
    // unknowns have the same unit.
    Matrix6d to_origin = Matrix6d::Identity();
    to_origin.topLeftCorner<3, 3>() /= arm;
    to_origin.bottomLeftCorner<3, 3>() = -derivative_by_rotation(centre) / arm;
    NormalEquations<double> equations;
    double squares = 0;
    double weights = 0;
    for (const Row& row : current) {
      const auto weight = static_cast<double>(
          tukey_weight(static_cast<float>(row.spread_m), static_cast<float>(4.7 * scale)));
      equations.add(row.equations.in_terms_of(to_origin), weight);
      squares += weight * row.distance_m * row.distance_m;
      weights += weight;
    }
    const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(equations.squares);
    // Planes whose normals differ by less than a few degrees are the same plane plus noise.
    const double least = 0.004 * eigen.eigenvalues()[5];
    const double deviation = std::sqrt(squares / std::max(weights - 6, 1.0));
    Motion change = Motion::Zero();
    result.determined = 0;
    result.undetermined.clear();
    result.deviation_m = 0;
    for (int i = 5; i >= 0; --i) {
      const Motion direction = eigen.eigenvectors().col(i);
      if (!(eigen.eigenvalues()[i] > least)) {
        result.undetermined.push_back(direction_name(direction));
        continue;
      }
      change += direction * direction.dot(equations.products) / eigen.eigenvalues()[i];
      result.deviation_m =
          std::max(result.deviation_m, deviation / std::sqrt(eigen.eigenvalues()[i]));
      ++result.determined;
    }
    result.color_from_depth = to_transform(to_origin * change) * result.color_from_depth;
    current = rows(result.color_from_depth);
    if (change.norm() < 1e-8) break;
  }
  result.error_m = root_mean_square(distances(current));
  return result;
}

}  // namespace diminish
