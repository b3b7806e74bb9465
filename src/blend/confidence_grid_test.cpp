#include "blend/confidence_grid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace diminish {
namespace {

constexpr Rect grid_region{40, 24, 162, 90};
const Intrinsics grid_view{320, 240, 300, 300, 160, 120, {}};

/// Confidence in each pixel of a plane at z = 2 m, where `resolution(column, row)` of a cell is
/// known.
template <class Resolution>
Image<float> confidence(const CameraPlace& place, const Resolution& resolution) {
  ConfidenceGrid grid;
  grid.begin(grid_region, grid_view, 1);
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      grid.set(0, column, row, resolution(column, row), 2);
    }
  }
  grid.finish(0, place);
  Image<float> result(grid_region.width, grid_region.height);
  std::vector<float> nodes;
  for (int y = 0; y < grid_region.height; ++y) grid.row(0, y, nodes, result.row(y));
  return result;
}

CameraPlace camera_at(const Eigen::Vector3d& eye_m) {
  RigidTransform color_from_depth;
  color_from_depth.translation = eye_m;
  return CameraPlace(color_from_depth);
}

TEST(ConfidenceGrid, IsTheResolutionOverTheAngleBetweenTheLinesOfSight) {
  const Eigen::Vector3d eye(0.9, -0.4, 0.3);
  for (const float resolution : {0.3F, 1.F, 3.F}) {
    const Image<float> found = confidence(camera_at(eye), [&](int, int) { return resolution; });
    for (const auto& [x, y] : {std::pair(10, 10), std::pair(80, 50), std::pair(150, 80)}) {
      const Eigen::Vector3d point =
          2 * Eigen::Vector3d((grid_region.x + x - grid_view.cx) / grid_view.fx,
                              (grid_region.y + y - grid_view.cy) / grid_view.fy, 1);
      const double angle = std::acos(point.normalized().dot((point - eye).normalized()));
      const double expected = std::min(1.F, resolution) / (angle + ConfidenceGrid::least_angle);
      EXPECT_NEAR(found(x, y) / expected, 1, 0.02) << resolution << ' ' << x << ' ' << y;
    }
  }
}

// Nothing jumps from pixel to pixel or where the camera's surface ends.
TEST(ConfidenceGrid, FadesToNothingBeforeTheSurfaceEnds) {
  constexpr int last_column = 13;
  constexpr int edge = (last_column + 1) * ConfidenceGrid::cell_px;
  const auto covers = [](int column, int row) {
    return column <= last_column && !(column == 3 && row == 8) ? 1.F : 0.F;
  };
  const Image<float> found = confidence(camera_at({0.5, 0, 0}), covers);
  const float full = found(edge - 1 - ConfidenceGrid::fading_px, 5);
  EXPECT_GT(full, 3);
  for (int y = 0; y < grid_region.height; ++y) {
    for (int x = 0; x < grid_region.width; ++x) {
      if (x >= edge - 1) {
        ASSERT_EQ(found(x, y), 0) << x << ' ' << y;
      }
      if (x > 0) {
        ASSERT_LT(std::abs(found(x, y) - found(x - 1, y)), full / 7) << x << ' ' << y;
      }
      if (y > 0) {
        ASSERT_LT(std::abs(found(x, y) - found(x, y - 1)), full / 7) << x << ' ' << y;
      }
    }
  }
  // Also at the hole of one cell.
  EXPECT_EQ(found(3 * ConfidenceGrid::cell_px + 3, 8 * ConfidenceGrid::cell_px + 4), 0);
}

TEST(ConfidenceGrid, TakesRegionsSmallerThanACell) {
  ConfidenceGrid grid;
  for (const int width : {1, 2, 3, 5, 9}) {
    grid.begin({7, 7, width, 2}, grid_view, 1);
    for (int column = 0; column < grid.columns(); ++column) grid.set(0, column, 0, 0.5F, 2);
    grid.finish(0, camera_at({0.5, 0, 0}));
    std::vector<float> nodes;
    std::vector<float> row(static_cast<std::size_t>(width) + 1, -1);
    grid.row(0, 1, nodes, row.data());
    for (int x = 0; x < width; ++x) EXPECT_GT(row[static_cast<std::size_t>(x)], 0.5F);
    EXPECT_EQ(row.back(), -1);
  }
}

}  // namespace
}  // namespace diminish
