#include "estimate/feature_planes.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>

#include "core/mat.h"
#include "core/tasks.h"

namespace diminish {
namespace {

constexpr int usual_columns = 960;
constexpr int features_of_picture = 1500;
/// How much better than the second best a match has to be.
constexpr float best_by = 0.8F;
/// From an epipolar line, and from where a plane says.
constexpr double agreement_px = 2.5;
constexpr std::size_t least_points = 12;
constexpr int attempts = 400;
/// Of all points, that may lie behind a plane.
constexpr double most_behind = 0.1;
constexpr double behind_by = 0.05;  ///< of the distance

struct Features {
  std::vector<Eigen::Vector2d> pixels;
  cv::Mat descriptors;
};

Features find_features(const FeaturePicture& picture) {
  const int by = std::max(1, (picture.picture.width() + usual_columns - 1) / usual_columns);
  const cv::Size size(picture.picture.width() / by, picture.picture.height() / by);
  cv::Mat grey;
  cv::Mat scene;
  cv::cvtColor(as_mat(picture.picture), grey, cv::COLOR_BGR2GRAY);
  cv::resize(grey, grey, size, 0, 0, cv::INTER_AREA);
  cv::resize(as_mat(picture.objects), scene, size, 0, 0, cv::INTER_NEAREST);
  cv::bitwise_not(scene, scene);
  std::vector<cv::KeyPoint> points;
  Features features;
  cv::ORB::create(features_of_picture, 1.2F, 8, 15, 0, 2, cv::ORB::HARRIS_SCORE, 31, 10)
      ->detectAndCompute(grey, scene, points, features.descriptors);
  for (const cv::KeyPoint& point : points) {
    features.pixels.emplace_back((point.pt.x + 0.5) * by - 0.5, (point.pt.y + 0.5) * by - 0.5);
  }
  return features;
}

/// A point that both cameras see.
struct SeenPoint {
  Eigen::Vector2d ray;  ///< of the first camera
  Eigen::Vector2d in_second;
  double inverse_depth;
};

/// The point of the first camera's ray that is nearest to the second camera's.
std::optional<SeenPoint> triangulate(const Eigen::Vector2d& first, const Eigen::Vector2d& second,
                                     const FeaturePicture& a, const FeaturePicture& b,
                                     const RigidTransform& second_from_first) {
  const Eigen::Vector2d ray = a.lens.undistort(first);
  const Eigen::Vector3d u = second_from_first.rotation * ray.homogeneous();
  const Eigen::Vector3d v = b.lens.undistort(second).homogeneous();
  // z u + t = w v
  Eigen::Matrix<double, 3, 2> sides;
  sides << u, -v;
  const Eigen::Vector2d z = sides.colPivHouseholderQr().solve(-second_from_first.translation);
  if (!(z.x() > 0.05 && z.y() > 0.05 && z.x() < 100)) return std::nullopt;
  const auto seen = b.lens.project(z.x() * u + second_from_first.translation);
  if (!seen || (*seen - second).norm() > agreement_px) return std::nullopt;
  return SeenPoint{ray, second, 1 / z.x()};
}

std::vector<SeenPoint> find_points(const FeaturePicture& first, const FeaturePicture& second,
                                   const RigidTransform& second_from_first) {
  Features a;
  Features b;
  do_all([&] { a = find_features(first); }, [&] { b = find_features(second); });
  std::vector<SeenPoint> points;
  if (a.pixels.size() < least_points || b.pixels.size() < least_points) return points;
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher(cv::NORM_HAMMING).knnMatch(a.descriptors, b.descriptors, matches, 2);
  for (const std::vector<cv::DMatch>& match : matches) {
    if (match.size() == 2 && match[0].distance > best_by * match[1].distance) continue;
    if (match.empty()) continue;
    const auto point = triangulate(a.pixels[static_cast<std::size_t>(match[0].queryIdx)],
                                   b.pixels[static_cast<std::size_t>(match[0].trainIdx)], first,
                                   second, second_from_first);
    if (point) points.push_back(*point);
  }
  return points;
}

/// Where the second camera sees a ray's point on the plane.
bool is_on(const InversePlane& plane, const SeenPoint& point, const Lens& second,
           const RigidTransform& second_from_first) {
  const double inverse_depth = plane.inverse_depth(point.ray);
  if (!(inverse_depth > 0.01)) return false;
  const auto seen = second.project(second_from_first * (point.ray.homogeneous() / inverse_depth));
  return seen && (*seen - point.in_second).norm() < agreement_px;
}

/// The plane nearest to the points' inverse depths, in the sense of least squares.
InversePlane fit(const std::vector<SeenPoint>& points, const std::vector<std::size_t>& members) {
  Eigen::MatrixX3d rays(static_cast<Eigen::Index>(members.size()), 3);
  Eigen::VectorXd inverse_depths(rays.rows());
  for (Eigen::Index i = 0; i < rays.rows(); ++i) {
    const SeenPoint& point = points[members[static_cast<std::size_t>(i)]];
    rays.row(i) = point.ray.homogeneous().transpose();
    inverse_depths(i) = point.inverse_depth;
  }
  return {rays.colPivHouseholderQr().solve(inverse_depths), {}};
}

std::vector<std::size_t> members_of(const InversePlane& plane, const std::vector<SeenPoint>& points,
                                    const std::vector<std::size_t>& among, const Lens& second,
                                    const RigidTransform& second_from_first) {
  std::vector<std::size_t> members;
  for (const std::size_t i : among) {
    if (is_on(plane, points[i], second, second_from_first)) members.push_back(i);
  }
  return members;
}

bool is_background(const InversePlane& plane, const std::vector<SeenPoint>& points) {
  const auto behind = std::count_if(points.begin(), points.end(), [&](const SeenPoint& point) {
    return plane.inverse_depth(point.ray) > point.inverse_depth * (1 + behind_by);
  });
  return static_cast<double>(behind) <= most_behind * static_cast<double>(points.size());
}

}  // namespace

std::vector<InversePlane> find_feature_planes(const FeaturePicture& first,
                                              const FeaturePicture& second,
                                              const RigidTransform& second_from_first, int most) {
  const std::vector<SeenPoint> points = find_points(first, second, second_from_first);
  std::vector<std::size_t> rest(points.size());
  for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = i;
  std::mt19937 random(1);
  std::vector<InversePlane> planes;
  while (static_cast<int>(planes.size()) < most && rest.size() >= least_points) {
    std::vector<std::size_t> best;
    for (int attempt = 0; attempt < attempts; ++attempt) {
      const auto pick = [&] { return rest[random() % rest.size()]; };
      const std::vector<std::size_t> three = {pick(), pick(), pick()};
      const InversePlane plane = fit(points, three);
      if (!plane.is_finite()) continue;
      auto members = members_of(plane, points, rest, second.lens, second_from_first);
      if (members.size() > best.size()) best = std::move(members);
    }
    if (best.size() < least_points) break;
    const InversePlane plane = fit(points, best);
    std::vector<std::size_t> left;
    for (const std::size_t i : rest) {
      if (!std::binary_search(best.begin(), best.end(), i)) left.push_back(i);
    }
    rest = left;
    if (plane.is_finite() && is_background(plane, points)) planes.push_back(plane);
  }
  return planes;
}

}  // namespace diminish
