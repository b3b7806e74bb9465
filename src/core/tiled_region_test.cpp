#include "diminish/tiled_region.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace diminish {
namespace {

TEST(TiledRegion, IsTheRectangleAtFirst) {
  const TiledRegion region(Rect{20, 30, 50, 40});
  EXPECT_TRUE(region.is_whole());
  EXPECT_TRUE(region.keeps(20, 30));
  EXPECT_TRUE(region.touches({0, 0, 21, 31}));
  EXPECT_FALSE(region.touches({0, 0, 20, 31}));
  region.for_each_gap(30, [](int, int) { FAIL(); });
}

// Against distances between tiles, one by one.
TEST(TiledRegion, KeepsTheTilesNearObjects) {
  Mask mask(300, 200, 0);
  std::mt19937 random(1);
  for (int i = 0; i < 12; ++i) {
    mask(static_cast<int>(random() % 300), static_cast<int>(random() % 200)) = 255;
  }
  TiledRegion region(Rect{13, 21, 277, 158});
  for (const int distance_px : {0, 16, 17}) {
    region.keep_near(mask, distance_px);
    const int reach = distance_px == 0 ? 0 : distance_px == 16 ? 1 : 2;
    int kept = 0;
    for (int y = region.y; y < region.bottom(); ++y) {
      for (int x = region.x; x < region.right(); ++x) {
        bool is_near = false;
        for (int j = region.y; j < region.bottom(); ++j) {
          for (int i = region.x; i < region.right(); ++i) {
            is_near = is_near || (mask(i, j) != 0 && std::abs(i / 16 - x / 16) <= reach &&
                                  std::abs(j / 16 - y / 16) <= reach);
          }
        }
        ASSERT_EQ(region.keeps(x, y), is_near) << x << ' ' << y << ' ' << distance_px;
        kept += is_near ? 1 : 0;
        x = std::min(x / 16 * 16 + 15, region.right());
      }
      y = std::min(y / 16 * 16 + 15, region.bottom());
    }
    EXPECT_GT(kept, 0);
  }
}

TEST(TiledRegion, TouchesAndGapsFollowFromItsPixels) {
  Mask mask(300, 200, 0);
  mask.fill({40, 50, 30, 9}, 255);
  mask.fill({200, 90, 3, 80}, 255);
  TiledRegion region(Rect{5, 7, 290, 180});
  region.keep_near(mask, 16);
  for (int y = region.y; y < region.bottom(); ++y) {
    std::vector<bool> is_gap(300, false);
    region.for_each_gap(y, [&](int first, int last) {
      ASSERT_LT(first, last);
      for (int x = first; x < last; ++x) is_gap[static_cast<std::size_t>(x)] = true;
    });
    for (int x = region.x; x < region.right(); ++x) {
      ASSERT_EQ(is_gap[static_cast<std::size_t>(x)], !region.keeps(x, y)) << x << ' ' << y;
    }
  }
  std::mt19937 random(2);
  for (int i = 0; i < 500; ++i) {
    const Rect part{static_cast<int>(random() % 280), static_cast<int>(random() % 180),
                    1 + static_cast<int>(random() % 40), 1 + static_cast<int>(random() % 40)};
    bool any = false;
    const Rect inside = intersect(part, region);
    for (int y = inside.y; y < inside.bottom(); ++y) {
      for (int x = inside.x; x < inside.right(); ++x) any = any || region.keeps(x, y);
    }
    // Whole tiles are looked at.
    if (any) {
      EXPECT_TRUE(region.touches(part));
    }
    if (!region.touches(part)) {
      EXPECT_FALSE(any);
    }
  }
}

TEST(TiledRegion, KeepsChosenTilesAndVisitsTheirRuns) {
  TiledRegion region(Rect{13, 21, 100, 60});
  const auto wanted = [](int x, int y) { return (x / 16 + 2 * (y / 16)) % 3 != 0; };
  region.keep_if([&](const Rect& tile) {
    EXPECT_EQ(tile.width, TiledRegion::tile);
    return wanted(tile.x, tile.y);
  });
  for (int y = region.y; y < region.bottom(); ++y) {
    std::vector<int> visits(200, 0);
    region.for_each_run(y, [&](int first, int last) {
      EXPECT_LT(first, last);
      for (int x = first; x < last; ++x) ++visits[static_cast<std::size_t>(x)];
    });
    for (int x = 0; x < 200; ++x) {
      const bool is_kept = region.contains(x, y) && wanted(x, y);
      ASSERT_EQ(visits[static_cast<std::size_t>(x)], is_kept ? 1 : 0) << x << ' ' << y;
      if (region.contains(x, y)) {
        ASSERT_EQ(region.keeps(x, y), is_kept);
        ASSERT_EQ(region.touches({x, y, 1, 1}), is_kept);
      }
    }
  }
}

}  // namespace
}  // namespace diminish
