#include "depth/depth_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

#include "diminish/image.h"
#include "stepped_surface.h"

namespace diminish {
namespace {

constexpr float unit_m = 0.001F;
const DepthNoise noise;

/// Slanted surfaces with steps between them, noise, flying pixels and holes.
Image<std::uint16_t> room(int width, int height) {
  Image<std::uint16_t> depth(width, height);
  std::mt19937 random(7);
  std::normal_distribution<float> jitter(0, 4);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float z = testing::stepped_surface(x, y);
      if (random() % 11 == 0) z += 150;
      z += jitter(random);
      depth(x, y) = random() % 13 == 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(z);
    }
  }
  return depth;
}

// The plain versions, a pixel at a time.

bool is_flying(const std::uint16_t* pixel, std::ptrdiff_t pitch) {
  if (*pixel == 0) return false;
  const float z = static_cast<float>(*pixel) * unit_m;
  const auto at = [&](std::ptrdiff_t offset) { return static_cast<float>(pixel[offset]) * unit_m; };
  for (const std::ptrdiff_t offset : {std::ptrdiff_t{1}, std::ptrdiff_t{-1}, pitch, -pitch}) {
    const float beyond = at(offset);
    if (beyond == 0 || std::abs(beyond - z) <= 2.5F * noise.at(z)) continue;
    const float first = at(-offset);
    const float second = at(-2 * offset);
    if (first == 0) return true;
    if (std::abs(first - z) <= 1.5F * noise.at(z)) continue;
    const float inverse = second > 0 ? 2 / first - 1 / second : 1 / first;
    if (std::abs(1 - inverse * z) * z > 2.5F * noise.at(z)) return true;
  }
  return false;
}

/// Of all pixels nearer the camera than another: does one lie too far over?
void remove_hidden(const std::vector<float>& place, const std::vector<float>& depth_m, float margin,
                   float threshold_m, std::vector<std::uint16_t>& depth) {
  const auto pass = [&](std::size_t first, std::size_t count, bool forwards) {
    float front = -std::numeric_limits<float>::infinity();
    float front_m = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t x = forwards ? first + i : first - i;
      if (depth[x] == 0) continue;
      const float own = forwards ? place[x] : -place[x];
      if (front > own - margin && front_m < depth_m[x] - threshold_m) {
        depth[x] = 0;
      } else if (own > front) {
        front = own;
        front_m = depth_m[x];
      }
    }
  };
  pass(0, depth.size(), true);
  pass(depth.size() - 1, depth.size(), false);
}

TEST(DepthRows, FlyingPixelsAreThoseOfThePlainVersion) {
  const Image<std::uint16_t> depth = room(151, 40);
  int flying = 0;
  for (int y = 2; y < 38; ++y) {
    Image<std::uint16_t> result = depth;
    depth_rows::remove_flying({depth.row(y) + 2, 147, unit_m, noise}, depth.width(),
                              result.row(y) + 2);
    for (int x = 2; x < 149; ++x) {
      const bool gone = is_flying(&depth(x, y), depth.width());
      ASSERT_EQ(result(x, y), gone ? 0 : depth(x, y)) << x << ' ' << y;
      flying += gone ? 1 : 0;
    }
  }
  EXPECT_GT(flying, 300);
}

TEST(DepthRows, HiddenPixelsAreThoseOfThePlainVersion) {
  const int width = 151;
  std::vector<float> ray_x(width), ray_y(width, 0.1F);
  for (int x = 0; x < width; ++x) ray_x[x] = (static_cast<float>(x) - 75) / 120;
  const float margin = 1 / 120.F;
  const Image<std::uint16_t> depth = room(width, 60);
  int hidden = 0;
  for (int y = 0; y < 60; ++y) {
    // The sensors are beside each other, on either side.
    RigidTransform to_color;
    to_color.rotation = Eigen::AngleAxisd(0.05, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
    to_color.translation = {y % 2 == 0 ? 0.05 : -0.05, 0.01, 0.002};
    const depth_rows::Places places{ray_x.data(), ray_y.data(), FloatTransform(to_color)};
    std::vector<std::uint16_t> result(depth.row(y), depth.row(y) + width);
    // Half of the rows have long surfaces without noise.
    for (int x = 0; y % 4 < 2 && x < width; ++x) {
      result[x] = x / 50 % 2 == 0 ? std::uint16_t{1500} : std::uint16_t{1000};
    }
    std::vector<std::uint16_t> expected = result;
    std::vector<float> depth_m(width), place(width);
    for (int x = 0; x < width; ++x) {
      depth_m[x] = static_cast<float>(result[x]) * unit_m;
      const Eigen::Vector3d point_m =
          to_color * Eigen::Vector3d(depth_m[x] * Eigen::Vector3d(ray_x[x], ray_y[x], 1));
      place[x] = static_cast<float>(point_m.x() / point_m.z());
    }
    remove_hidden(place, depth_m, margin, 0.05F, expected);
    std::vector<float> scratch(width + 16), more_scratch(width + 16);
    depth_rows::remove_hidden(places, unit_m, margin, 0.05F, width, result.data(), scratch.data(),
                              more_scratch.data());
    ASSERT_EQ(result, expected) << "row " << y;
    for (int x = 0; x < width; ++x) hidden += depth(x, y) != 0 && result[x] == 0 ? 1 : 0;
  }
  EXPECT_GT(hidden, 300);
}

TEST(DepthRows, JumpsAreThoseOfThePlainVersion) {
  const Image<std::uint16_t> depth = room(151, 40);
  constexpr int steps = 3;
  constexpr int piece = depth_rows::piece;
  int found = 0;
  int pieces = 0;
  for (const std::ptrdiff_t step : {1, 151}) {
    for (const std::uint16_t limit : {std::uint16_t{20}, std::uint16_t{150}, std::uint16_t{900}}) {
      for (int y = 0; y < 40 - steps; ++y) {
        const int count = 151 - steps;
        std::vector<std::uint8_t> has_jump(static_cast<std::size_t>(count / piece), 7);
        depth_rows::find_jumps(depth.row(y), count, step, steps, limit, has_jump.data());
        for (int x = 0; x + piece <= count; x += piece) {
          bool expected = false;
          for (int i = x; i < x + piece; ++i) {
            for (int k = 1; k <= steps; ++k) {
              const int a = depth.row(y)[i];
              const int b = depth.row(y)[i + k * step];
              expected |= a != 0 && b != 0 && std::abs(a - b) > limit;
            }
          }
          ASSERT_EQ(has_jump[static_cast<std::size_t>(x / piece)] != 0, expected) << x << ' ' << y;
          found += expected ? 1 : 0;
          ++pieces;
        }
      }
    }
  }
  EXPECT_GT(found, pieces / 5);
  EXPECT_LT(found, pieces * 4 / 5);
}

TEST(DepthRows, GapsAreKeptAsByThePlainVersion) {
  const Image<std::uint16_t> depth = room(151, 40);
  const depth_rows::Gap gap{200, 40, 0.00006F};
  int kept = 0;
  int flagged = 0;
  for (int y = 2; y < 38; ++y) {
    std::vector<std::uint8_t> flags(147);
    for (std::size_t i = 0; i < flags.size(); ++i) flags[i] = (i / 20 + i) % 3 == 0 ? 1 : 0;
    std::vector<std::uint8_t> result = flags;
    depth_rows::keep_gaps(depth.row(y) + 2, depth.width(), 147, gap, result.data());
    for (int i = 0; i < 147; ++i) {
      int least = 65535;
      int most = 0;
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          const int value = depth(2 + i + dx, y + dy);
          if (dx * dx + dy * dy > 4 || value == 0) continue;
          least = std::min(least, value);
          most = std::max(most, value);
        }
      }
      const auto flag = static_cast<std::size_t>(i);
      const bool expected = flags[flag] != 0 && most > least && gap.is_between(least, most) != 0;
      ASSERT_EQ(result[flag], expected ? 1 : 0) << i << ' ' << y;
      kept += result[flag];
      flagged += flags[flag];
    }
  }
  EXPECT_GT(kept, flagged / 5);
  EXPECT_LT(kept, flagged * 4 / 5);
}

TEST(DepthRows, WhatIsMaskedIsLeftOut) {
  const Image<std::uint16_t> depth = room(151, 1);
  std::vector<std::uint8_t> mask(151);
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = i % 7 < 3 ? 255 : 0;
  for (const int count : {1, 15, 16, 151}) {
    std::vector<std::uint16_t> result(152, 9);
    depth_rows::leave_out(depth.row(0), mask.data(), count, result.data());
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      ASSERT_EQ(result[k], mask[k] != 0 ? 0 : depth(i, 0)) << i;
    }
    EXPECT_EQ(result[static_cast<std::size_t>(count)], 9) << count;
  }
}

TEST(DepthRows, FlagsOfSeveralRowsAreUnited) {
  std::mt19937 random(5);
  std::vector<std::vector<std::uint8_t>> rows(5, std::vector<std::uint8_t>(151));
  for (auto& row : rows) {
    for (std::uint8_t& bits : row) bits = static_cast<std::uint8_t>(1U << random() % 8);
  }
  for (std::size_t row_count = 1; row_count <= rows.size(); ++row_count) {
    for (const int count : {1, 31, 32, 65, 151}) {
      std::vector<const std::uint8_t*> united;
      for (std::size_t k = 0; k < row_count; ++k) united.push_back(rows[k].data());
      std::vector<std::uint8_t> result(152, 9);
      depth_rows::unite(united, count, result.data());
      for (int i = 0; i < count; ++i) {
        std::uint8_t expected = 0;
        for (const std::uint8_t* row : united) expected |= row[i];
        ASSERT_EQ(result[static_cast<std::size_t>(i)], expected) << i;
      }
      EXPECT_EQ(result[static_cast<std::size_t>(count)], 9) << count;
    }
  }
}

}  // namespace
}  // namespace diminish
