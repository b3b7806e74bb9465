#include "blend/scraps.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <queue>
#include <random>
#include <vector>

namespace diminish {
namespace {

constexpr int map_width = 256;
constexpr int map_height = 96;
constexpr int least_pixels =
    (map_width / Scraps::squares_across) * (map_width / Scraps::squares_across);
const sdct::Threshold step(0.05, 2);

class ScrapsTest : public ::testing::Test {
 protected:
  ScrapsTest() : mask(map_width, map_height) {
    mask.fill(objects, 255);
    scene.region = Rect{0, 0, map_width, map_height};
    scene.color.resize(map_width, map_height, {});
    scene.depth_m.resize(map_width, map_height, 0.F);
    scene.source.resize(map_width, map_height, 0);
    draw(mask.bounds(), 2.F);
  }

  void draw(int x, int y, float z_m) {
    scene.depth_m(x, y) = z_m;
    scene.color(x, y) = {1, 2, 3, 255};
    scene.source(x, y) = 1;
  }
  void draw(const Rect& part, float z_m) {
    for (int y = part.y; y < part.bottom(); ++y) {
      for (int x = part.x; x < part.right(); ++x) draw(x, y, z_m);
    }
  }
  void remove() { Scraps().remove(mask, grow(objects, 16), step, scene); }
  bool is_drawn(int x, int y) const {
    const bool is = scene.source(x, y) != 0;
    EXPECT_EQ(scene.depth_m(x, y) > 0, is);
    EXPECT_EQ(scene.color(x, y).a, is ? 255 : 0);
    return is;
  }

  const Rect objects{20, 20, 200, 60};
  Mask mask;
  Reconstruction scene;
};

TEST_F(ScrapsTest, DropsWhatIsSmallAndHangsInTheAir) {
  static_assert(least_pixels == 16);
  draw({40, 40, 5, 3}, 1.5F);   // too small
  draw({80, 40, 4, 4}, 1.5F);   // large enough
  draw({120, 40, 1, 1}, 2.5F);  // a hole through which something else shows
  remove();
  EXPECT_FALSE(is_drawn(42, 41));
  EXPECT_TRUE(is_drawn(45, 41));
  EXPECT_TRUE(is_drawn(82, 41));
  EXPECT_FALSE(is_drawn(120, 40));
}

TEST_F(ScrapsTest, LeavesWhatIsOutsideTheMask) {
  draw({18, 40, 4, 3}, 1.5F);
  remove();
  EXPECT_TRUE(is_drawn(19, 41));
  EXPECT_FALSE(is_drawn(20, 41));
}

TEST_F(ScrapsTest, FollowsASlope) {
  // From the wall to 1 m before it, a step of 4 cm at a time.
  for (int x = 60; x <= 85; ++x) draw({x, 30, 1, 40}, 2.F - 0.04F * static_cast<float>(x - 60));
  const Reconstruction before = scene;
  remove();
  EXPECT_EQ(before.source, scene.source);
}

TEST_F(ScrapsTest, AlsoClearsTheSecondView) {
  scene.second.color.resize(map_width, map_height, {9, 9, 9, 255});
  scene.second.source.resize(map_width, map_height, 2);
  scene.second.share.resize(map_width, map_height, 100);
  draw({40, 40, 2, 2}, 1.5F);
  remove();
  EXPECT_EQ(scene.second.share(41, 41), 0);
  EXPECT_EQ(scene.second.source(41, 41), 0);
  EXPECT_EQ(scene.second.color(41, 41).a, 0);
  EXPECT_EQ(scene.second.share(43, 41), 100);
}

TEST_F(ScrapsTest, DoesNothingWhereNothingIsDrawn) {
  draw(mask.bounds(), 0);
  scene.source.fill(mask.bounds(), 0);
  scene.color.fill(mask.bounds(), {});
  remove();
  EXPECT_FALSE(is_drawn(100, 50));
  Scraps().remove(mask, {0, 0, 0, 0}, step, scene);
}

/// The pixels that are connected to this one, by a plain search.
std::vector<std::array<int, 2>> piece_around(int x, int y, const Image<float>& depth_m) {
  std::vector<std::array<int, 2>> piece;
  Mask is_found(depth_m.width(), depth_m.height());
  std::queue<std::array<int, 2>> open;
  const auto find = [&](int u, int v) {
    is_found(u, v) = 1;
    open.push({u, v});
    piece.push_back({u, v});
  };
  find(x, y);
  while (!open.empty()) {
    const auto [u, v] = open.front();
    open.pop();
    for (const auto& [du, dv] : {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      if (!depth_m.bounds().contains(u + du, v + dv) || is_found(u + du, v + dv) != 0) continue;
      const float a = depth_m(u, v);
      const float b = depth_m(u + du, v + dv);
      if (b > 0 && std::abs(a - b) < step.at(std::min(a, b))) find(u + du, v + dv);
    }
  }
  return piece;
}

TEST_F(ScrapsTest, DoesWhatAPlainSearchDoes) {
  mask.fill(mask.bounds(), 255);
  std::mt19937 random(5);
  std::discrete_distribution<int> choose({3, 4, 2, 1});
  constexpr float depths_m[] = {0, 2, 1.7F, 3.5F};
  for (int y = 0; y < map_height; ++y) {
    for (int x = 0; x < map_width; ++x) {
      const float z_m = depths_m[choose(random)];
      draw(x, y, z_m);
      if (z_m == 0) scene.source(x, y) = scene.color(x, y).a = 0;
    }
  }
  const Image<float> before = scene.depth_m;
  Scraps().remove(mask, mask.bounds(), step, scene);
  int dropped = 0;
  int kept = 0;
  for (int y = 0; y < map_height; ++y) {
    for (int x = 0; x < map_width; ++x) {
      if (before(x, y) == 0) continue;
      const bool is_large = piece_around(x, y, before).size() >= least_pixels;
      ASSERT_EQ(is_drawn(x, y), is_large) << x << ' ' << y;
      ++(is_large ? kept : dropped);
    }
  }
  EXPECT_GT(dropped, 1000);
  EXPECT_GT(kept, 1000);
}

}  // namespace
}  // namespace diminish
