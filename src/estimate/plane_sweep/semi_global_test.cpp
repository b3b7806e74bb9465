#include "estimate/plane_sweep/semi_global.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include "each_vector_target.h"
#include "estimate/plane_sweep/census.h"

namespace diminish {
namespace {

constexpr float none = SemiGlobalMatching::none;

/// A random texture, a few pixels coarse.
Image<std::uint8_t> texture(int width, int height, unsigned seed) {
  Image<std::uint8_t> grey(width, height);
  std::mt19937 random(seed);
  for (std::uint8_t& level : grey) level = static_cast<std::uint8_t>(1 + random() % 255);
  return grey;
}

Image<std::uint32_t> codes_of(const Image<std::uint8_t>& grey) {
  Image<std::uint32_t> codes(grey.width(), grey.height());
  census(grey, grey.bounds(), codes);
  return codes;
}

/// A small scene, and its matching written down as it is defined.
struct Scene {
  Image<std::uint8_t> reference;
  Image<std::uint32_t> reference_census, other_census;
  Parallax parallax;
  SweepPlanes planes;

  MatchedViews views() const { return {reference, reference_census, other_census, parallax}; }

  int cost(int x, int y, int k) const {
    const float d = planes.inverse_depth(static_cast<float>(k));
    const float s = parallax.scale(d);
    const auto u =
        static_cast<int>(std::nearbyint(static_cast<float>(x) * s + parallax.shift_x(d, s)));
    const auto v =
        static_cast<int>(std::nearbyint(static_cast<float>(y) * s + parallax.shift_y(d, s)));
    const bool inside = other_census.bounds().contains(u, v);
    return std::popcount(reference_census(x, y) ^
                         (inside ? other_census(u, v) : other_census(0, 0)));
  }
  /// What a path pays for leaping where brightness changes.
  static int leap(int change) { return std::max(20, 30 * 12 / (12 + std::abs(change))); }

  std::vector<int> sums(int at_x, int at_y) const {
    std::vector<int> all(static_cast<std::size_t>(planes.count), 0);
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      // From the border on
      int x = dx == 0 ? at_x : dx > 0 ? 0 : reference.width() - 1;
      int y = dy == 0 ? at_y : dy > 0 ? 0 : reference.height() - 1;
      std::vector<int> before(all.size(), 0);
      int last = reference(x, y);
      for (;; x += dx, y += dy) {
        const int least = *std::min_element(before.begin(), before.end());
        std::vector<int> here(all.size());
        for (std::size_t k = 0; k < here.size(); ++k) {
          int best = std::min(before[k], least + leap(reference(x, y) - last));
          if (k > 0) best = std::min(best, before[k - 1] + 3);
          if (k + 1 < here.size()) best = std::min(best, before[k + 1] + 3);
          here[k] = cost(x, y, static_cast<int>(k)) + best - least;
        }
        before = here;
        last = reference(x, y);
        if (x == at_x && y == at_y) break;
      }
      for (std::size_t k = 0; k < all.size(); ++k) all[k] += before[k];
    }
    return all;
  }

  float plane(int x, int y) const {
    std::vector<int> costs = sums(x, y);
    const auto best = std::min_element(costs.begin(), costs.end()) - costs.begin();
    if (best == 0 || best == planes.count - 1) return none;
    const auto at = [&](std::ptrdiff_t k) { return costs[static_cast<std::size_t>(k)]; };
    const int bend = at(best - 1) + at(best + 1) - 2 * at(best);
    const float found = static_cast<float>(best) +
                        (bend > 0 ? 0.5F * static_cast<float>(at(best - 1) - at(best + 1)) /
                                        static_cast<float>(bend)
                                  : 0);
    const int least = at(best);
    std::fill_n(costs.begin() + best - 1, 3, 255);
    return *std::min_element(costs.begin(), costs.end()) - least >= 2 ? found : none;
  }
};

TEST(SemiGlobalMatching, IsWhatItsDefinitionSays) {
  Scene scene;
  scene.reference = texture(47, 21, 1);
  scene.reference_census = codes_of(scene.reference);
  scene.other_census = codes_of(texture(60, 25, 2));
  scene.parallax =
      Parallax(Intrinsics{.width = 47, .height = 21, .fx = 50, .fy = 50, .cx = 23, .cy = 10},
               {-0.2, 0.01, 0.05});
  scene.planes = {0.4F, 0.03F, 40};
  testing::on_each_vector_target([&] {
    SemiGlobalMatching matching;
    Image<float> found;
    matching.match(scene.views(), scene.planes, found);
    for (int y = 0; y < found.height(); ++y) {
      for (int x = 0; x < found.width(); ++x)
        ASSERT_EQ(found(x, y), scene.plane(x, y)) << x << ' ' << y;
    }
  });
}

TEST(SemiGlobalMatching, FindsHowFarAPictureIsShifted) {
  // The left half is 7 planes away, the right half 12, each a pixel of shift.
  const int width = 120;
  const int height = 60;
  const Image<std::uint8_t> other = texture(width + 40, height, 4);
  Scene scene;
  scene.reference.resize(width, height);
  const auto shift = [](int x) { return x < 60 ? 7 : 12; };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) scene.reference(x, y) = other(x + shift(x), y);
  }
  scene.reference_census = codes_of(scene.reference);
  scene.other_census = codes_of(other);
  scene.parallax.x = 1;  // a pixel for each unit of inverse depth
  scene.planes = {0, 1, 20};
  SemiGlobalMatching matching;
  Image<float> found;
  matching.match(scene.views(), scene.planes, found);
  int right = 0;
  int all = 0;
  for (int y = 2; y < height - 2; ++y) {
    for (int x = 2; x < width - 2; ++x) {
      if (std::abs(x - 60) < 4) continue;
      ++all;
      right += std::abs(found(x, y) - static_cast<float>(shift(x))) < 0.5F ? 1 : 0;
    }
  }
  EXPECT_EQ(right, all);
}

TEST(SemiGlobalMatching, KnowsNothingOfASmoothWall) {
  Scene scene;
  scene.reference = Image<std::uint8_t>(40, 30, 90);
  scene.reference_census = codes_of(scene.reference);
  scene.other_census = codes_of(Image<std::uint8_t>(60, 30, 90));
  scene.parallax.x = 1;
  scene.planes = {0, 1, 16};
  SemiGlobalMatching matching;
  Image<float> found;
  matching.match(scene.views(), scene.planes, found);
  for (const float plane : found) EXPECT_EQ(plane, none);
}

}  // namespace
}  // namespace diminish
