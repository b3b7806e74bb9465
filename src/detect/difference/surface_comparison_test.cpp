#include "detect/difference/surface_comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "each_vector_target.h"

namespace diminish {
namespace {

/// Random surfaces and neighbourhoods, some without a surface, some with one, of awkward counts;
/// beside the definition in double precision.
TEST(SurfaceComparison, IsAsDefined) {
  constexpr std::size_t most = 61;
  std::mt19937 random(1);
  const auto byte = [&] { return static_cast<std::uint8_t>(random() % 256); };
  std::vector<SeenSurface> nearest(most);
  std::vector<SeenSurface> farthest(most);
  std::vector<Bgr> least(most);
  std::vector<Bgr> greatest(most);
  for (std::size_t i = 0; i < most; ++i) {
    const Bgr a{byte(), byte(), byte()};
    const Bgr b{byte(), byte(), byte()};
    least[i] = {std::min(a.b, b.b), std::min(a.g, b.g), std::min(a.r, b.r)};
    greatest[i] = {std::max(a.b, b.b), std::max(a.g, b.g), std::max(a.r, b.r)};
    if (i % 5 == 0) continue;
    nearest[i] = {1, {byte(), byte(), byte()}, static_cast<std::uint8_t>(1 + random() % 254)};
    farthest[i] = {i % 2 == 0 ? 1.01F : 1.5F, {byte(), byte(), byte()}, 1};
  }
  const auto distance = [](const Bgr& color, const Bgr& from, const Bgr& to) {
    const auto beyond = [](double value, double low, double high) {
      return value < low ? low - value : value > high ? value - high : 0;
    };
    return std::hypot(beyond(color.b, from.b, to.b), beyond(color.g, from.g, to.g),
                      beyond(color.r, from.r, to.r));
  };
  testing::on_each_vector_target([&] {
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{16}, most}) {
      std::vector<SurfaceDifference> found(count + 1, {-1, -1, -1});
      compare_surfaces(nearest.data(), farthest.data(), least.data(), greatest.data(),
                       static_cast<int>(count), found.data());
      for (std::size_t i = 0; i < count; ++i) {
        const double near_by = i % 5 == 0 ? 0 : distance(nearest[i].color, least[i], greatest[i]);
        const double far_by = i % 5 == 0   ? 0
                              : i % 2 == 0 ? near_by
                                           : distance(farthest[i].color, least[i], greatest[i]);
        ASSERT_NEAR(found[i].nearest, near_by, 1e-4) << i;
        ASSERT_NEAR(found[i].farthest, far_by, 1e-4) << i;
        ASSERT_NEAR(found[i].either, std::min(near_by, far_by), 1e-4) << i;
      }
      EXPECT_EQ(found[count].nearest, -1);  // nothing is written beyond
    }
  });
}

}  // namespace
}  // namespace diminish
