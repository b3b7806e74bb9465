#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "core/mat.h"
#include "diminish/board.h"
#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"
#include "pose/opencv_aruco.h"

namespace diminish::testing {

/// A printed sheet in space. Its frame: origin at its centre, x right, y up, z out of it.
struct Target {
  cv::Mat texture;  ///< 8 bit
  double width_m = 0, height_m = 0;
  RigidTransform world_from_target;
};

/// A marker of DICT_4X4_50 with a white rim of `rim` cells, drawn by OpenCV.
inline Target marker_target(int id, double size_m, const RigidTransform& world_from_target,
                            int rim = 1) {
  constexpr int cell_px = 40;
  constexpr int cells = 6;
  cv::Mat picture;
  opencv_aruco::draw(opencv_aruco::dictionary(cv::aruco::DICT_4X4_50), id, cells * cell_px,
                     picture);
  cv::copyMakeBorder(picture, picture, rim * cell_px, rim * cell_px, rim * cell_px, rim * cell_px,
                     cv::BORDER_CONSTANT, cv::Scalar(255));
  const double side = size_m * (cells + 2 * rim) / cells;
  return {picture, side, side, world_from_target};
}

/// A board with a white rim of half a square; ChArUco boards drawn by OpenCV.
inline Target board_target(const Board& board, const RigidTransform& world_from_target) {
  constexpr int square_px = 120;
  cv::Mat picture;
  int columns = board.columns;
  int rows = board.rows;
  if (board.kind == Board::Kind::charuco) {
    const auto charuco = opencv_aruco::make_board(
        {columns, rows}, static_cast<float>(board.square_m), static_cast<float>(board.marker_m),
        opencv_aruco::dictionary(cv::aruco::DICT_4X4_50));
    opencv_aruco::draw(charuco, {columns * square_px, rows * square_px}, picture);
  } else {
    ++columns;
    ++rows;
    picture.create(rows * square_px, columns * square_px, CV_8U);
    for (int y = 0; y < picture.rows; ++y) {
      for (int x = 0; x < picture.cols; ++x) {
        picture.at<std::uint8_t>(y, x) = (x / square_px + y / square_px) % 2 == 0 ? 0 : 255;
      }
    }
  }
  constexpr int rim = square_px / 2;
  cv::copyMakeBorder(picture, picture, rim, rim, rim, rim, cv::BORDER_CONSTANT, cv::Scalar(255));
  return {picture, (columns + 1) * board.square_m, (rows + 1) * board.square_m, world_from_target};
}

/// Renders targets in front of a wall, with one ray for each of a pixel's samples.
class TargetRenderer {
 public:
  explicit TargetRenderer(const Intrinsics& intrinsics)
      : width_(intrinsics.width), height_(intrinsics.height) {
    // Rays at pixel corners; between them rays are linear to a millionth.
    const Lens lens(intrinsics);
    corners_.resize(width_ + 1, height_ + 1);
    centres_.resize(width_, height_);
    for (int y = 0; y <= height_; ++y) {
      for (int x = 0; x <= width_; ++x) {
        corners_(x, y) = lens.undistort({x - 0.5, y - 0.5});
        if (x < width_ && y < height_) {
          centres_(x, y) = lens.undistort(Eigen::Vector2d(x, y));
        }
      }
    }
  }

  /// The wall is grey, with waves of 10 cm, at `wall_m` along the world's negative z.
  Image<Bgr> color(const std::vector<Target>& targets, const RigidTransform& camera_from_world,
                   double blur_px, double noise_levels, unsigned seed) const {
    const std::vector<View> views = look(targets, camera_from_world);
    const RigidTransform world_from_camera = camera_from_world.inverse();
    constexpr int samples = 4;
    cv::Mat picture(height_, width_, CV_32F);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        float sum = 0;
        for (int i = 0; i < samples * samples; ++i) {
          const int sample_row = i / samples;
          const double u = (i % samples + 0.5) / samples;
          const double v = (sample_row + 0.5) / samples;
          const Eigen::Vector2d ray =
              (1 - v) * ((1 - u) * corners_(x, y) + u * corners_(x + 1, y)) +
              v * ((1 - u) * corners_(x, y + 1) + u * corners_(x + 1, y + 1));
          sum += brightness(views, world_from_camera, ray);
        }
        picture.at<float>(y, x) = sum / (samples * samples);
      }
    }
    if (blur_px > 0) cv::GaussianBlur(picture, picture, {}, blur_px);
    std::mt19937 random(seed);
    std::normal_distribution<float> gauss(0, 1);
    Image<Bgr> image(width_, height_);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const float noise = static_cast<float>(noise_levels) * gauss(random);
        const auto level = cv::saturate_cast<std::uint8_t>(picture.at<float>(y, x) + noise);
        image(x, y) = {level, level, level};
      }
    }
    return image;
  }

  Image<std::uint16_t> depth(const std::vector<Target>& targets,
                             const RigidTransform& camera_from_world, double unit_m, double noise_m,
                             unsigned seed) const {
    const std::vector<View> views = look(targets, camera_from_world);
    const RigidTransform world_from_camera = camera_from_world.inverse();
    std::mt19937 random(seed);
    std::normal_distribution<double> gauss(0, noise_m);
    Image<std::uint16_t> image(width_, height_);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        double nearest = wall_distance(world_from_camera, centres_(x, y));
        for (const View& view : views) nearest = std::min(nearest, view.hit(centres_(x, y)).first);
        const double value = (nearest + gauss(random)) / unit_m;
        image(x, y) =
            value > 0 && value < 65535 ? static_cast<std::uint16_t>(std::lround(value)) : 0;
      }
    }
    return image;
  }

  double wall_m = 2;  ///< the wall is the world's plane z = -wall_m

 private:
  struct View {
    const Target* target;
    RigidTransform target_from_camera;

    /// The depth of the target along a ray (infinite if it misses), and the place on it.
    std::pair<double, Eigen::Vector2d> hit(const Eigen::Vector2d& ray) const {
      const Eigen::Vector3d direction = target_from_camera.rotation * ray.homogeneous();
      const double z = -target_from_camera.translation.z() / direction.z();
      const Eigen::Vector3d p = target_from_camera.translation + z * direction;
      const bool inside = z > 0 && direction.z() < 0 && std::abs(p.x()) * 2 < target->width_m &&
                          std::abs(p.y()) * 2 < target->height_m;
      return {inside ? z : std::numeric_limits<double>::infinity(), p.head<2>()};
    }
  };

  static std::vector<View> look(const std::vector<Target>& targets,
                                const RigidTransform& camera_from_world) {
    std::vector<View> views;
    views.reserve(targets.size());
    for (const Target& target : targets) {
      views.push_back({&target, (camera_from_world * target.world_from_target).inverse()});
    }
    return views;
  }

  double wall_distance(const RigidTransform& world_from_camera, const Eigen::Vector2d& ray) const {
    const Eigen::Vector3d direction = world_from_camera.rotation * ray.homogeneous();
    const double z = (-wall_m - world_from_camera.translation.z()) / direction.z();
    return z > 0 ? z : std::numeric_limits<double>::infinity();
  }

  float brightness(const std::vector<View>& views, const RigidTransform& world_from_camera,
                   const Eigen::Vector2d& ray) const {
    double nearest = std::numeric_limits<double>::infinity();
    float value = 0;
    for (const View& view : views) {
      const auto [z, place] = view.hit(ray);
      if (!(z < nearest)) continue;
      nearest = z;
      const cv::Mat& texture = view.target->texture;
      const double u = (place.x() / view.target->width_m + 0.5) * texture.cols;
      const double v = (0.5 - place.y() / view.target->height_m) * texture.rows;
      value = 20.F +
              0.8F * texture.at<std::uint8_t>(std::clamp(static_cast<int>(v), 0, texture.rows - 1),
                                              std::clamp(static_cast<int>(u), 0, texture.cols - 1));
    }
    if (nearest < std::numeric_limits<double>::infinity()) return value;
    const double z = wall_distance(world_from_camera, ray);
    if (!std::isfinite(z)) return 120;
    const Eigen::Vector3d p = world_from_camera * (z * ray.homogeneous());
    return static_cast<float>(130 + 30 * std::sin(p.x() * 62.8) * std::sin(p.y() * 50));
  }

  int width_, height_;
  Image<Eigen::Vector2d> corners_, centres_;
};

}  // namespace diminish::testing
