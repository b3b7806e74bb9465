#include "scene/background_planes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/rows.h"
#include "scene/surface_rows.h"

namespace diminish {
namespace {

constexpr int hypotheses = 160;
constexpr std::size_t fewest_points = 60;
/// Shares of the points around the objects.
constexpr double smallest_support = 0.12;
constexpr double most_behind = 0.04;

/// A small random generator that is the same on every machine.
class Random {
 public:
  std::size_t below(std::size_t end) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return static_cast<std::size_t>(state_ >> 33) % end;
  }

 private:
  std::uint64_t state_ = 1;
};

BackgroundPlane facing_camera(Eigen::Vector3f normal, const Eigen::Vector3f& point) {
  float distance = normal.dot(point);
  if (distance > 0) {
    normal = -normal;
    distance = -distance;
  }
  return {normal, distance};
}

/// Fits a plane by least squares.
BackgroundPlane fit(const BackgroundPlane& plane, const PlanePoints& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  double count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(plane.height_m(points[i])) > points.tolerance_m[i]) continue;
    const Eigen::Vector3d p = points[i].cast<double>();
    sum += p;
    squares += p * p.transpose();
    ++count;
  }
  if (count < 3) return plane;
  const Eigen::Vector3d mean = sum / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares / count -
                                                              mean * mean.transpose());
  return facing_camera(solver.eigenvectors().col(0).cast<float>(), mean.cast<float>());
}

/// The points that are no further from the plane than their error bounds; counts only on while they
/// may become more than `most`.
int count_on(const BackgroundPlane& plane, const PlanePoints& points, int most) {
  constexpr std::size_t some = 64;
  int count = 0;
  const std::size_t size = points.size();
  for (std::size_t first = 0; first < size; first += some) {
    const std::size_t end = std::min(first + some, size);
    for (std::size_t i = first; i < end; ++i) {
      count += std::abs(points.height_m(plane, i)) <= points.tolerance_m[i] ? 1 : 0;
    }
    if (count + static_cast<int>(size - end) <= most) break;
  }
  return count;
}
int count_behind(const BackgroundPlane& plane, const PlanePoints& points) {
  int count = 0;
  const std::size_t size = points.size();
  for (std::size_t i = 0; i < size; ++i) {
    count += points.height_m(plane, i) < -2 * points.tolerance_m[i] ? 1 : 0;
  }
  return count;
}

}  // namespace

void BackgroundPlanes::find(const Rect& objects, const std::vector<SceneSample>& samples) {
  choose_points(objects, samples);
  planes_.clear();
  rest_ = points_;
  BackgroundPlane plane;
  while (planes_.size() < most_planes && next_plane(plane)) planes_.push_back(plane);
}

void BackgroundPlanes::label(const Reconstruction& reconstruction, Surfaces& surfaces) const {
  const TiledRegion& region = reconstruction.region;
  const Image<float>& depth_m = reconstruction.depth_m;
  Image<std::uint8_t>& label = surfaces.label;
  const Rect& box = region;
  surfaces.region = box;
  label.resize(depth_m.width(), depth_m.height());
  for_rows(region.height, [&](Rows rows) {
    for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
      int begin = region.x;
      region.for_each_gap(y, [&](int first, int last) {
        label_run(begin, first, y, depth_m, label);
        std::fill(label.row(y) + first, label.row(y) + last, surface_label::unknown);
        begin = last;
      });
      label_run(begin, region.right(), y, depth_m, label);
    }
  });
}

/// Points around the objects: a plane far away says nothing about what is behind them.
void BackgroundPlanes::choose_points(const Rect& objects, const std::vector<SceneSample>& samples) {
  const int margin = std::max(100, std::max(objects.width, objects.height) / 2);
  const Rect around = grow(objects, margin);
  points_.clear();
  for (const SceneSample& sample : samples) {
    const int x = static_cast<int>(sample.pixel.x());
    const int y = static_cast<int>(sample.pixel.y());
    if (around.contains(x, y)) points_.add(sample.point_m, tolerance.at(sample.point_m.z()));
  }
}

/// The plane with most of the points that are on no plane yet and hardly any points behind it
/// (RANSAC, Fischler & Bolles 1981).
bool BackgroundPlanes::next_plane(BackgroundPlane& plane) {
  const auto wanted = std::max<std::size_t>(
      fewest_points / 2,
      static_cast<std::size_t>(smallest_support * static_cast<double>(points_.size())));
  if (rest_.size() < std::max(fewest_points, wanted)) return false;
  Random random;
  const std::size_t stride = std::max<std::size_t>(1, rest_.size() / 300);
  some_.thin(points_, stride);
  some_of_rest_.thin(rest_, stride);
  int most = 0;
  for (int i = 0; i < hypotheses; ++i) {
    const Eigen::Vector3f a = rest_[random.below(rest_.size())];
    const Eigen::Vector3f b = rest_[random.below(rest_.size())];
    const Eigen::Vector3f c = rest_[random.below(rest_.size())];
    const Eigen::Vector3f normal = (b - a).cross(c - a);
    const float length = normal.norm();
    if (!(length > 1e-4F)) continue;
    const BackgroundPlane candidate = facing_camera(normal / length, a);
    const int on = count_on(candidate, some_of_rest_, most);
    if (on <= most) continue;
    const int behind = count_behind(candidate, some_);
    if (behind > most_behind * static_cast<double>(some_.size())) continue;
    most = on;
    plane = candidate;
  }
  if (static_cast<std::size_t>(most) * stride < wanted) return false;
  for (int i = 0; i < 3; ++i) plane = fit(plane, rest_);
  rest_.erase_if([&](const Eigen::Vector3f& point, float tolerance_m) {
    return std::abs(plane.height_m(point)) <= 1.5F * tolerance_m;
  });
  return plane.distance_m < 0;
}

void BackgroundPlanes::label_run(int first, int last, int y, const Image<float>& depth_m,
                                 Image<std::uint8_t>& label) const {
  static_assert(most_planes <= surface_rows::most_planes);
  constexpr std::size_t at_once = 32;
  std::array<surface_rows::Segment, at_once> segments;
  for (int x = first; x < last;) {
    const int begin = x;
    std::size_t count = 0;
    for (; count < at_once && x < last; ++count) {
      const RayGrid::Segment rays = rays_.segment(x, y, last);
      surface_rows::Segment& segment = segments[count];
      segment.count = rays.count;
      // Along a row, a plane's inverse depth is linear.
      for (std::size_t k = 0; k < planes_.size(); ++k) {
        segment.planes[k] = {planes_[k].inverse_depth(rays.first.x(), rays.first.y()),
                             planes_[k].normal.head<2>().dot(rays.slope) / planes_[k].distance_m};
      }
      x += rays.count;
    }
    surface_rows::label(depth_m.row(y) + begin, {segments.data(), count},
                        static_cast<int>(planes_.size()), tolerance, label.row(y) + begin);
  }
}

}  // namespace diminish
