#include "blend/confidence_grid.h"

#include <algorithm>
#include <cmath>

namespace diminish {
namespace {

/// Weighted sums of 2 * reach + 1 neighbours along rows, then along columns. Beyond the border the
/// last value is repeated.
template <std::size_t reach>
void filter(const float (&weights)[2 * reach + 1], Image<float>& image, Image<float>& scratch) {
  constexpr int r = reach;
  const int width = image.width();
  const int height = image.height();
  for (int y = 0; y < height; ++y) {
    const float* from = image.row(y);
    float* to = scratch.row(y);
    const auto sum_at = [&](int x, auto at) {
      float sum = 0;
      for (int i = -r; i <= r; ++i) sum += weights[i + r] * from[at(x + i)];
      return sum;
    };
    const auto clamped = [&](int x) { return std::clamp(x, 0, width - 1); };
    const int left = std::min(r, width);
    const int right = std::max(left, width - r);
    for (int x = 0; x < left; ++x) to[x] = sum_at(x, clamped);
    for (int x = left; x < right; ++x) to[x] = sum_at(x, [](int i) { return i; });
    for (int x = right; x < width; ++x) to[x] = sum_at(x, clamped);
  }
  for (int y = 0; y < height; ++y) {
    float* to = image.row(y);
    std::fill_n(to, width, 0.F);
    for (int i = -r; i <= r; ++i) {
      const float* from = scratch.row(std::clamp(y + i, 0, height - 1));
      for (int x = 0; x < width; ++x) to[x] += weights[i + r] * from[x];
    }
  }
}

}  // namespace

void ConfidenceGrid::begin(const Rect& region, const Intrinsics& color, std::size_t cameras) {
  region_ = region;
  color_ = color;
  columns_ = std::max(1, region.width / cell_px);
  rows_ = std::max(1, region.height / cell_px);
  if (cameras_.size() < cameras) cameras_.resize(cameras);
  for (std::size_t k = 0; k < cameras; ++k) {
    Camera& camera = cameras_[k];
    for (Image<float>* image :
         {&camera.resolution, &camera.z_m, &camera.confidence, &camera.scratch}) {
      image->resize(columns_, rows_);
    }
  }
}

Rect ConfidenceGrid::cell(int column, int row) const {
  const int x = column * cell_px;
  const int y = row * cell_px;
  return {x, y, column == columns_ - 1 ? region_.width - x : cell_px,
          row == rows_ - 1 ? region_.height - y : cell_px};
}

void ConfidenceGrid::set(std::size_t camera, int column, int row, float resolution, float z_m) {
  cameras_[camera].resolution(column, row) =
      resolution > 0 ? std::min(resolution, most_resolution) : not_covered;
  cameras_[camera].z_m(column, row) = z_m;
}

void ConfidenceGrid::finish(std::size_t which, const CameraPlace& place) {
  Camera& camera = cameras_[which];
  std::copy(camera.resolution.begin(), camera.resolution.end(), camera.confidence.begin());
  constexpr float mean = 1.F / (2 * reach + 1);
  filter<reach>({mean, mean, mean, mean, mean}, camera.confidence, camera.scratch);
  trust(camera, place);
  filter<1>(smoothing, camera.confidence, camera.scratch);
}

void ConfidenceGrid::trust(Camera& camera, const CameraPlace& place) const {
  constexpr float half_cell = (cell_px - 1) / 2.F;
  const Eigen::Vector3f first = pinhole_ray(color_, static_cast<float>(region_.x) + half_cell,
                                            static_cast<float>(region_.y) + half_cell);
  const float step_x = cell_px / static_cast<float>(color_.fx);
  const float step_y = cell_px / static_cast<float>(color_.fy);
  const Eigen::Vector3f& eye = place.eye_m;
  for (int row = 0; row < rows_; ++row) {
    const float ray_y = first.y() + step_y * static_cast<float>(row);
    const float* z = camera.z_m.row(row);
    float* confidence = camera.confidence.row(row);
    for (int column = 0; column < columns_; ++column) {
      const float ray_x = first.x() + step_x * static_cast<float>(column);
      const float x = ray_x * z[column];
      const float y = ray_y * z[column];
      const float away_x = x - eye.x();
      const float away_y = y - eye.y();
      const float away_z = z[column] - eye.z();
      const float lengths = std::sqrt((x * x + y * y + z[column] * z[column]) *
                                      (away_x * away_x + away_y * away_y + away_z * away_z));
      const float cosine = (x * away_x + y * away_y + z[column] * away_z) / (lengths + 1e-9F);
      // The chord is nearly the angle, and cheaper.
      const float angle = std::sqrt(std::max(0.F, 2 - 2 * cosine));
      const float resolution = std::clamp(confidence[column], 0.F, 1.F);
      confidence[column] = resolution / (angle + least_angle);
    }
  }
}

void ConfidenceGrid::row(std::size_t which, int y, std::vector<float>& nodes,
                         float* confidence) const {
  const Image<float>& grid = cameras_[which].confidence;
  constexpr float half_cell = (cell_px - 1) / 2.F;
  const float place =
      std::clamp((static_cast<float>(y) - half_cell) / cell_px, 0.F, static_cast<float>(rows_ - 1));
  const int upper = static_cast<int>(place);
  const float* above = grid.row(upper);
  const float* below = grid.row(std::min(upper + 1, rows_ - 1));
  const float part = place - static_cast<float>(upper);
  nodes.resize(static_cast<std::size_t>(columns_));
  for (int i = 0; i < columns_; ++i) {
    nodes[static_cast<std::size_t>(i)] = above[i] + part * (below[i] - above[i]);
  }
  // Nodes are the cells' centres, which lie between two pixels.
  int x = std::min(cell_px / 2, region_.width);
  std::fill_n(confidence, x, nodes.front());
  for (std::size_t i = 1; i < nodes.size(); ++i, x += cell_px) {
    const float step = (nodes[i] - nodes[i - 1]) / cell_px;
    for (int j = 0; j < cell_px; ++j) {
      confidence[x + j] = nodes[i - 1] + (static_cast<float>(j) + 0.5F) * step;
    }
  }
  std::fill(confidence + x, confidence + region_.width, nodes.back());
}

}  // namespace diminish
