#include "core/joined_runs.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace diminish {
namespace {

constexpr int width = 90;

std::vector<bool> covered_by(const std::vector<ColumnRun>& runs) {
  std::vector<bool> covered(width, false);
  for (const ColumnRun& run : runs) {
    for (int x = run.first; x < run.last; ++x) covered[static_cast<std::size_t>(x)] = true;
  }
  return covered;
}

// Column by column.
TEST(JoinedRuns, CoverWhatTheRunsCover) {
  std::mt19937 random(3);
  JoinedRuns joined;
  for (int round = 0; round < 300; ++round) {
    joined.clear();
    std::vector<ColumnRun> runs(random() % 9);
    for (ColumnRun& run : runs) {
      run.first = static_cast<int>(random() % (width - 10));
      run.last = run.first + 1 + static_cast<int>(random() % 10);
      joined.add(run);
    }
    const std::vector<bool> expected = covered_by(runs);
    EXPECT_EQ(covered_by(joined.runs()), expected);
    const std::vector<ColumnRun>& in_order = joined.in_order();
    EXPECT_EQ(covered_by(in_order), expected);
    for (std::size_t i = 1; i < in_order.size(); ++i) {
      EXPECT_GT(in_order[i].first, in_order[i - 1].last);
    }
  }
}

// Pixel by pixel: a mask grown by a square.
TEST(MaskRuns, NearARowAreThoseOfTheRowsAround) {
  std::mt19937 random(5);
  constexpr Rect part{3, 2, 80, 20};
  for (const Pixels pixels : {Pixels::set, Pixels::clear}) {
    Mask mask(width, 26);
    for (std::uint8_t& pixel : mask) pixel = random() % 9 == 0 ? 255 : 0;
    MaskRuns runs;
    runs.find(mask, part, pixels);
    for (const int reach : {0, 2}) {
      for (int y = 0; y < mask.height(); ++y) {
        std::vector<bool> expected(width, false);
        for (int x = part.x; x < part.right(); ++x) {
          for (int row = y - reach; row <= y + reach; ++row) {
            if (!part.contains(x, row)) continue;
            if ((mask(x, row) != 0) == (pixels == Pixels::set)) {
              expected[static_cast<std::size_t>(x)] = true;
            }
          }
        }
        JoinedRuns joined;
        runs.for_each_near(y, reach, [&](const ColumnRun& run, int rows) {
          EXPECT_LE(rows, reach);
          joined.add(run);
        });
        EXPECT_EQ(covered_by(joined.runs()), expected) << "row " << y;
      }
    }
  }
}

}  // namespace
}  // namespace diminish
