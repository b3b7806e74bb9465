#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "diminish/calibration.h"

namespace diminish {
namespace {

constexpr int cell_columns = 10;
constexpr int cell_rows = 8;
constexpr std::size_t most_views = 120;
/// Views count as the same if their corners are closer than this share of the image's width.
constexpr double same_view = 0.02;

/// The mean distance of the corners that both views have; infinite if these are less than half.
double distance_px(const BoardView& a, const BoardView& b) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.ids.size(); ++i) {
    const auto same = std::find(b.ids.begin(), b.ids.end(), a.ids[i]);
    if (same == b.ids.end()) continue;
    sum += (a.pixels[i] - b.pixels[static_cast<std::size_t>(same - b.ids.begin())]).norm();
    ++count;
  }
  const bool enough = 2 * count >= std::max(a.ids.size(), b.ids.size());
  return enough ? sum / static_cast<double>(count) : std::numeric_limits<double>::infinity();
}

/// 0: the board faces the camera; 1 to 4: it is tilted left, right, back, forward. Assumes a usual
/// focal length, as the camera's is not known yet.
std::size_t tilt_of(const BoardView& view, int width, int height) {
  std::vector<cv::Point2d> pixels;
  std::vector<cv::Point3d> points;
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    pixels.emplace_back(view.pixels[i].x(), view.pixels[i].y());
    points.emplace_back(view.points_m[i].x(), view.points_m[i].y(), 0);
  }
  const double focal_length = std::max(width, height);
  const cv::Matx33d camera(focal_length, 0, width / 2.0, 0, focal_length, height / 2.0, 0, 0, 1);
  cv::Vec3d rotation;
  cv::Vec3d translation;
  if (!cv::solvePnP(points, pixels, camera, cv::noArray(), rotation, translation, false,
                    cv::SOLVEPNP_IPPE)) {
    return 0;
  }
  cv::Matx33d matrix;
  cv::Rodrigues(rotation, matrix);
  // Relative to the image plane: a board parallel to it says nothing about the focal length.
  cv::Vec3d normal(matrix(0, 2), matrix(1, 2), matrix(2, 2));
  if (normal[2] < 0) normal = -normal;
  const double x = normal[0] / normal[2];
  const double y = normal[1] / normal[2];
  constexpr double tan_15_degrees = 0.268;
  if (std::max(std::abs(x), std::abs(y)) < tan_15_degrees) return 0;
  if (std::abs(x) > std::abs(y)) return x < 0 ? 1 : 2;
  return y < 0 ? 3 : 4;
}

}  // namespace

ViewCollection::ViewCollection(int width, int height)
    : width_(width), height_(height), cells_(cell_columns, cell_rows, 0) {}

std::string ViewCollection::add(BoardView view) {
  for (const BoardView& other : views_) {
    if (distance_px(view, other) < same_view * width_) {
      return "shows the board like " + other.name;
    }
  }
  if (views_.size() == most_views) return fmt::format("already {} views", most_views);
  Image<int> touched(cell_columns, cell_rows, 0);
  for (const Eigen::Vector2d& pixel : view.pixels) {
    const int x = static_cast<int>((pixel.x() + 0.5) / width_ * cell_columns);
    const int y = static_cast<int>((pixel.y() + 0.5) / height_ * cell_rows);
    touched(std::clamp(x, 0, cell_columns - 1), std::clamp(y, 0, cell_rows - 1)) = 1;
  }
  for (int y = 0; y < cell_rows; ++y) {
    for (int x = 0; x < cell_columns; ++x) cells_(x, y) += touched(x, y);
  }
  ++tilt_counts_[tilt_of(view, width_, height_)];
  views_.push_back(std::move(view));
  return "";
}

double ViewCollection::coverage() const {
  const auto empty = std::count(cells_.begin(), cells_.end(), 0);
  return 1 - static_cast<double>(empty) / static_cast<double>(cells_.size());
}

int ViewCollection::tilts() const {
  return static_cast<int>(
      std::count_if(tilt_counts_.begin(), tilt_counts_.end(), [](int n) { return n > 0; }));
}

bool ViewCollection::is_ample() const {
  return views_.size() >= 20 && coverage() >= 0.85 && tilts() == 5;
}

}  // namespace diminish
