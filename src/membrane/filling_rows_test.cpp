#include "membrane/filling_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "each_vector_target.h"

namespace diminish::filling_rows {
namespace {

constexpr int width = 96;

/// Three rows of cells, some of which are not there, and runs of several lengths in the middle one.
struct Cells {
  std::vector<Color> rows[3];
  std::vector<Run> runs;

  explicit Cells(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> level(0, 255);
    for (auto& row : rows) {
      for (int x = 0; x < width; ++x) {
        row.emplace_back(level(random), level(random), level(random), 1);
        if (random() % 3 == 0) row.back().setZero();
      }
    }
    for (int x = 1 + static_cast<int>(random() % 3); x < width - 1;) {
      const int last = std::min(width - 1, x + 1 + static_cast<int>(random() % 12));
      runs.push_back({x, last});
      x = last + 1 + static_cast<int>(random() % 4);
    }
  }
};

void expect_same(const std::vector<Color>& a, const std::vector<Color>& b) {
  for (std::size_t x = 0; x < a.size(); ++x) {
    for (int c = 0; c < 4; ++c) {
      // What no cell is around is not a number.
      if (std::isnan(a[x][c]) && std::isnan(b[x][c])) continue;
      ASSERT_EQ(a[x][c], b[x][c]) << "column " << x << ", channel " << c;
    }
  }
}

TEST(FillingRows, RelaxesAsThePlainVersionDoes) {
  testing::on_each_vector_target([] {
    for (const float factor : {1.F, 1.7F}) {
      for (int i = 0; i < 20; ++i) {
        const Cells cells(static_cast<unsigned>(i));
        std::vector<Color> expected = cells.rows[1];
        std::vector<Color> relaxed = expected;
        plain::relax(cells.runs, i / 2, i % 2, factor, cells.rows[0].data(), cells.rows[2].data(),
                     expected.data());
        relax(cells.runs, i / 2, i % 2, factor, cells.rows[0].data(), cells.rows[2].data(),
              relaxed.data());
        expect_same(expected, relaxed);
      }
    }
  });
}

TEST(FillingRows, InterpolatesAsThePlainVersionDoes) {
  testing::on_each_vector_target([] {
    for (int i = 0; i < 20; ++i) {
      const Cells cells(static_cast<unsigned>(i));
      std::vector<Color> expected = cells.rows[1];
      std::vector<Color> interpolated = expected;
      plain::interpolate(cells.runs, i, cells.rows[0].data(), cells.rows[2].data(),
                         expected.data());
      interpolate(cells.runs, i, cells.rows[0].data(), cells.rows[2].data(), interpolated.data());
      expect_same(expected, interpolated);
    }
  });
}

TEST(FillingRows, RoundsAsThePlainVersionDoes) {
  std::mt19937 random(1);
  // They may overshoot.
  std::uniform_real_distribution<float> level(-20, 275);
  std::vector<Color> colors;
  for (int x = 0; x < width; ++x) colors.emplace_back(level(random), level(random), x, 1);
  testing::on_each_vector_target([&] {
    for (const int count : {0, 1, 2, 7, width}) {
      std::vector<Bgr> expected(width, {1, 2, 3});
      std::vector<Bgr> rounded = expected;
      plain::round(colors.data(), count, expected.data());
      round(colors.data(), count, rounded.data());
      EXPECT_EQ(expected, rounded) << count;
    }
  });
}

}  // namespace
}  // namespace diminish::filling_rows
