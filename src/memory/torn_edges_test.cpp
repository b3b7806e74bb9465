#include "memory/torn_edges.h"

#include <gtest/gtest.h>

#include <random>

#include "analytic_scene.h"

namespace diminish {
namespace {

/// A red wall 1 m away to the left of a blue one 2 m away; seen again from the same place, with a
/// gap between them.
class Torn : public ::testing::Test {
 protected:
  static constexpr Bgr red{0, 0, 255}, blue{255, 0, 0};

  Torn() {
    const Rect whole = rig.color.bounds();
    edge = whole.width / 2;
    picture.resize(whole.width, whole.height, blue);
    drawn.color.resize(whole.width, whole.height, Bgra{});
    drawn.depth_m.resize(whole.width, whole.height, 2.F);
    drawn.source.resize(whole.width, whole.height, 1);
    for (int y = 0; y < whole.height; ++y) {
      std::fill_n(picture.row(y), edge, red);
      std::fill_n(drawn.depth_m.row(y), edge, 1.F);
    }
    const Rect places = grid.intrinsics().bounds();
    depth.resize(places.width, places.height, units(2));
    for (int y = 0; y < places.height; ++y) {
      for (int x = 0; x * grid.step() < edge; ++x) depth(x, y) = units(1);
    }
    objects.resize(whole.width, whole.height, 255);
  }
  static std::uint16_t units(double z_m) {
    return static_cast<std::uint16_t>(std::lrint(z_m / KeyframeGrid::unit_m));
  }
  /// On row 20: nothing is drawn in columns [first, last). Returns how many are then.
  int close(int first, int last) {
    std::fill_n(drawn.source.row(row) + first, last - first, std::uint8_t{0});
    for (int y = 0; y < drawn.source.height(); ++y) {
      std::copy_n(drawn.source.row(row), drawn.source.width(), drawn.source.row(y));
    }
    TornEdges(rig.color, grid)
        .close({picture, depth, FloatTransform(RigidTransform())}, objects, rig.color.bounds(),
               drawn);
    return static_cast<int>(
        std::count(drawn.source.row(row) + first, drawn.source.row(row) + last, 1));
  }

  static constexpr int row = 20;
  const Rig rig = testing::small_rig();
  const KeyframeGrid grid{rig.color};
  int edge;
  Image<Bgr> picture;
  Image<std::uint16_t> depth;
  Mask objects;
  Reconstruction drawn;
};

TEST_F(Torn, BothSurfacesMeetWhereTheyEnd) {
  const int half = grid.step();
  EXPECT_EQ(close(edge - half, edge + half), 2 * half);
  // The edge is known to a place of the grid.
  for (int x = edge - half; x < edge + half; ++x) {
    const bool is_red = drawn.color(x, row).r == 255;
    EXPECT_EQ(is_red, x < edge) << x - edge;
    if (std::abs(x - edge) >= grid.step()) {
      EXPECT_EQ(drawn.depth_m(x, row), x < edge ? 1 : 2) << x - edge;
    }
  }
}

TEST_F(Torn, WideGapsStay) {
  const int width = 4 * grid.step() + 2;
  EXPECT_EQ(close(edge - width / 2, edge + width / 2), 0);
}

TEST_F(Torn, WhatTheKeyframeDoesNotShowStays) {
  depth.fill(0);
  EXPECT_EQ(close(edge - 1, edge + 1), 0);
}

TEST_F(Torn, OnlyTheObjectsAreCovered) {
  objects.fill(0);
  EXPECT_EQ(close(edge - 1, edge + 1), 0);
}

/// The nearest drawn pixel in a direction, not too far away: its depth, or 0.
float depth_beside(const Reconstruction& drawn, const Rect& part, int x, int y, int dx, int dy,
                   int reach) {
  for (int i = 1; i <= reach; ++i) {
    const int column = x + i * dx;
    const int row = y + i * dy;
    if (!part.contains(column, row)) return 0;
    if (drawn.source(column, row) != 0) return drawn.depth_m(column, row);
  }
  return 0;
}

// Against a search from each pixel.
TEST_F(Torn, AllNarrowGapsAreFound) {
  std::mt19937 random(1);
  const auto below = [&](int end) { return static_cast<int>(random() % unsigned(end)); };
  const Rect whole = rig.color.bounds();
  for (int hole = 0; hole < 400; ++hole) {
    const Rect part =
        intersect({below(whole.width), below(whole.height), 1 + below(12), 1 + below(12)}, whole);
    drawn.source.fill(part, 0);
    objects.fill(intersect({below(whole.width), below(whole.height), 6, 6}, whole), 0);
  }
  // All is on the blue wall, so that any gap can be closed.
  depth.fill(units(2));
  picture.fill(blue);
  drawn.depth_m.fill(2);
  const Reconstruction before = drawn;
  TiledRegion part(Rect{3, 5, whole.width - 9, whole.height - 12});
  part.keep_if([](const Rect& tile) { return (tile.x / 16 + tile.y / 16) % 7 != 0; });
  // What is not kept is not drawn.
  Reconstruction kept = before;
  for (int y = 0; y < whole.height; ++y) {
    for (int x = 0; x < whole.width; ++x) {
      if (!part.contains(x, y) || !part.keeps(x, y)) kept.source(x, y) = 0;
    }
  }
  drawn = kept;
  TornEdges(rig.color, grid)
      .close({picture, depth, FloatTransform(RigidTransform())}, objects, part, drawn);
  const int reach = 2 * grid.step();
  int closed = 0;
  for (int y = part.y; y < part.bottom(); ++y) {
    for (int x = part.x; x < part.right(); ++x) {
      if (kept.source(x, y) != 0) continue;
      const auto has = [&](int dx, int dy) {
        return depth_beside(kept, part, x, y, dx, dy, reach) > 0 &&
               depth_beside(kept, part, x, y, -dx, -dy, reach) > 0;
      };
      const bool is_narrow = objects(x, y) != 0 && (has(1, 0) || has(0, 1));
      ASSERT_EQ(drawn.source(x, y) != 0, is_narrow) << x << ' ' << y;
      closed += is_narrow ? 1 : 0;
    }
  }
  EXPECT_GT(closed, 500);
}

}  // namespace
}  // namespace diminish
