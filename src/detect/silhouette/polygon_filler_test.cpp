#include "detect/silhouette/polygon_filler.h"

#include <gtest/gtest.h>

#include <random>

namespace diminish {
namespace {

/// Whether a pixel is inside, by the rule in Polygons, without a division.
bool is_inside(const std::vector<Polygons::Corner>& corners, int column, int row) {
  const std::int64_t x = column * Polygons::subpixels;
  const std::int64_t y = row * Polygons::subpixels;
  bool inside = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    Polygons::Corner a = corners[i];
    Polygons::Corner b = corners[(i + 1) % corners.size()];
    if (a.y > b.y) std::swap(a, b);
    if (a.y > y || b.y <= y) continue;
    // The pixel lies on the edge or right of it.
    if ((x - a.x) * (b.y - a.y) >= (y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}

TEST(PolygonFiller, FillsByItsRule) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-20, 60);
  PolygonFiller filler;
  for (int i = 0; i < 300; ++i) {
    Polygons polygons;
    for (int k = 0; k < 3 + i % 9; ++k) {
      Eigen::Vector2d corner(anywhere(random), anywhere(random));
      if (i % 4 == 0) corner = corner.array().round();
      polygons.add_corner(corner);
    }
    polygons.end_polygon(1);
    Mask mask(41, 37, 0);
    std::uint8_t covers[2] = {};
    filler.fill(polygons, mask, covers);
    bool any = false;
    for (int y = 0; y < mask.height(); ++y) {
      for (int x = 0; x < mask.width(); ++x) {
        const bool inside = is_inside(polygons.corners, x, y);
        any = any || inside;
        ASSERT_EQ(mask(x, y), inside ? 255 : 0) << i << ": " << x << ", " << y;
      }
    }
    EXPECT_EQ(covers[0], 0);
    EXPECT_EQ(covers[1] != 0, any);
  }
}

// Triangles around a point, whose corners are on pixels' centres in part.
TEST(PolygonFiller, NeighboursNeitherOverlapNorLeaveGaps) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> anywhere(5, 35);
  PolygonFiller filler;
  for (int i = 0; i < 100; ++i) {
    Eigen::Vector2d middle(anywhere(random), anywhere(random));
    if (i % 2 == 0) middle = middle.array().round();
    const Eigen::Vector2d around[] = {{-1, -1}, {20, -1}, {41, -1}, {41, 20},
                                      {41, 41}, {20, 41}, {-1, 41}, {-1, 20}};
    Image<int> times(40, 40, 0);
    for (std::size_t k = 0; k < 8; ++k) {
      Polygons triangle;
      triangle.add_corner(middle);
      triangle.add_corner(around[k]);
      triangle.add_corner(around[(k + 1) % 8]);
      triangle.end_polygon(0);
      Mask mask(40, 40, 0);
      std::uint8_t covers = 0;
      filler.fill(triangle, mask, {&covers, 1});
      for (std::size_t p = 0; p < mask.size(); ++p) times.data()[p] += mask.data()[p] != 0 ? 1 : 0;
    }
    ASSERT_EQ(times, Image<int>(40, 40, 1)) << i;
  }
}

}  // namespace
}  // namespace diminish
