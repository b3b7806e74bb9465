#include "reconstruct/background_planes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/rows.h"

namespace diminish {
namespace {

constexpr int ray_step = 32;
constexpr int most_planes = 3;
constexpr int hypotheses = 160;
constexpr std::size_t fewest_points = 60;
/// Shares of the points around the objects.
constexpr double smallest_support = 0.12;
constexpr double most_behind = 0.04;

/// How far a measurement may be from the surface it is of: depth sensors' errors grow with the
/// square of the distance.
float tolerance_m(float depth_m) {
  return 0.012F + 0.006F * depth_m * depth_m;
}

/// Small, and the same everywhere.
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

/// Least squares.
BackgroundPlane fit(const BackgroundPlane& plane, const std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  double count = 0;
  for (const Eigen::Vector3f& point : points) {
    if (std::abs(plane.height_m(point)) > tolerance_m(point.z())) continue;
    const Eigen::Vector3d p = point.cast<double>();
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

}  // namespace

BackgroundPlanes::BackgroundPlanes(const Intrinsics& color) {
  const Lens lens(color);
  rays_.resize(color.width / ray_step + 2, color.height / ray_step + 2);
  for (int row = 0; row < rays_.height(); ++row) {
    for (int column = 0; column < rays_.width(); ++column) {
      rays_(column, row) = lens.undistort({column * ray_step, row * ray_step}).cast<float>();
    }
  }
}

void BackgroundPlanes::find(const Rect& objects, const std::vector<SceneSample>& samples) {
  choose_points(objects, samples);
  planes_.clear();
  rest_ = points_;
  BackgroundPlane plane;
  while (planes_.size() < most_planes && next_plane(plane)) planes_.push_back(plane);
}

void BackgroundPlanes::label(Reconstruction& reconstruction) const {
  Image<std::uint8_t>& surface = reconstruction.surface;
  surface.resize(reconstruction.source.width(), reconstruction.source.height());
  const Rect& region = reconstruction.region;
  for_rows(region.height, [&](Rows rows) {
    for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
      label_row(y, reconstruction);
    }
  });
}

/// Those around the objects: a plane far away says nothing about what is behind them.
void BackgroundPlanes::choose_points(const Rect& objects, const std::vector<SceneSample>& samples) {
  const int margin = std::max(100, std::max(objects.width, objects.height) / 2);
  const Rect around = grow(objects, margin);
  points_.clear();
  for (const SceneSample& sample : samples) {
    const int x = static_cast<int>(sample.pixel.x());
    const int y = static_cast<int>(sample.pixel.y());
    if (around.contains(x, y)) points_.push_back(sample.point_m);
  }
}

/// The plane that most of the points that are on no plane yet lie on, and hardly any behind
/// (RANSAC, Fischler & Bolles 1981).
bool BackgroundPlanes::next_plane(BackgroundPlane& plane) {
  if (rest_.size() < fewest_points) return false;
  const auto wanted = std::max<std::size_t>(
      fewest_points / 2,
      static_cast<std::size_t>(smallest_support * static_cast<double>(points_.size())));
  Random random;
  std::size_t most = 0;
  const std::size_t stride = std::max<std::size_t>(1, rest_.size() / 500);
  for (int i = 0; i < hypotheses; ++i) {
    const Eigen::Vector3f& a = rest_[random.below(rest_.size())];
    const Eigen::Vector3f& b = rest_[random.below(rest_.size())];
    const Eigen::Vector3f& c = rest_[random.below(rest_.size())];
    const Eigen::Vector3f normal = (b - a).cross(c - a);
    const float length = normal.norm();
    if (!(length > 1e-4F)) continue;
    const BackgroundPlane candidate = facing_camera(normal / length, a);
    std::size_t on = 0;
    for (std::size_t k = 0; k < rest_.size(); k += stride) {
      on += std::abs(candidate.height_m(rest_[k])) <= tolerance_m(rest_[k].z()) ? 1U : 0U;
    }
    if (on <= most) continue;
    std::size_t behind = 0;
    std::size_t all = 0;
    for (std::size_t k = 0; k < points_.size(); k += stride, ++all) {
      behind += candidate.height_m(points_[k]) < -2 * tolerance_m(points_[k].z()) ? 1U : 0U;
    }
    if (static_cast<double>(behind) > most_behind * static_cast<double>(all)) continue;
    most = on;
    plane = candidate;
  }
  if (most * stride < wanted) return false;
  for (int i = 0; i < 3; ++i) plane = fit(plane, rest_);
  std::erase_if(rest_, [&](const Eigen::Vector3f& point) {
    return std::abs(plane.height_m(point)) <= 1.5F * tolerance_m(point.z());
  });
  return plane.distance_m < 0;
}

void BackgroundPlanes::label_row(int y, Reconstruction& reconstruction) const {
  const Rect& region = reconstruction.region;
  std::uint8_t* surface = reconstruction.surface.row(y);
  const float* depth_m = reconstruction.depth_m.row(y);
  const int ray_row = y / ray_step;
  const float below = static_cast<float>(y % ray_step) / ray_step;
  const auto ray_at = [&](int column) -> Eigen::Vector2f {
    return (1 - below) * rays_(column, ray_row) + below * rays_(column, ray_row + 1);
  };
  for (int x = region.x; x < region.right();) {
    const int column = x / ray_step;
    const int end = std::min(region.right(), (column + 1) * ray_step);
    const Eigen::Vector2f left = ray_at(column);
    const Eigen::Vector2f step = (ray_at(column + 1) - left) / ray_step;
    // Along a row the inverse depth of a plane grows linearly.
    float inverse[most_planes] = {};
    float slope[most_planes] = {};
    const Eigen::Vector2f first = left + static_cast<float>(x % ray_step) * step;
    const Eigen::Vector2f second = first + step;
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      inverse[k] = planes_[k].inverse_depth(first.x(), first.y());
      slope[k] = planes_[k].inverse_depth(second.x(), second.y()) - inverse[k];
    }
    for (; x < end; ++x) {
      std::uint8_t nearest = surface_label::unknown;
      float greatest = 0;
      std::uint8_t own = surface_label::foreground;
      const float z = depth_m[x];
      for (std::size_t k = 0; k < planes_.size(); ++k) {
        const auto label = static_cast<std::uint8_t>(surface_label::first_plane + k);
        if (inverse[k] > greatest) {
          greatest = inverse[k];
          nearest = label;
        }
        // (1/z - inverse) z is the difference in depth, relative to the plane's.
        if (z > 0 && std::abs(1 - inverse[k] * z) * z <= 2 * tolerance_m(z)) own = label;
        inverse[k] += slope[k];
      }
      surface[x] = z > 0 ? own : nearest;
    }
  }
}

}  // namespace diminish
