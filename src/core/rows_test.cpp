#include "core/rows.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace diminish {
namespace {

TEST(Rows, BandsHoldEveryRowOnce) {
  for (const int least : {64, 128}) {
    for (int rows = 0; rows < 3000; rows += rows < 300 ? 1 : 97) {
      std::vector<int> visits(static_cast<std::size_t>(rows), 0);
      std::vector<int> bands(most_bands, 0);
      for_rows(
          rows,
          [&](Rows band) {
            ++bands[static_cast<std::size_t>(band.band)];
            EXPECT_EQ(band.first, band.band * band_height(rows, least));
            for (int y = band.first; y < band.last; ++y) ++visits[static_cast<std::size_t>(y)];
          },
          least);
      EXPECT_EQ(visits, std::vector<int>(visits.size(), 1)) << rows;
      for (const int times : bands) EXPECT_LE(times, 1) << rows;
    }
  }
}

TEST(Rows, GroupsHoldEveryRowOnce) {
  for (const int height : {1, 4, 16}) {
    for (int rows = 0; rows < 100; ++rows) {
      std::vector<int> visits(static_cast<std::size_t>(rows), 0);
      for_row_groups(rows, height, [&](Rows group) {
        EXPECT_EQ(group.first, group.band * height);
        for (int y = group.first; y < group.last; ++y) ++visits[static_cast<std::size_t>(y)];
      });
      EXPECT_EQ(visits, std::vector<int>(visits.size(), 1)) << rows;
    }
  }
}

TEST(Rows, FewRowsAreOneBand) {
  EXPECT_EQ(band_height(127), 127);
  EXPECT_EQ(band_height(128), 64);
  EXPECT_EQ(band_height(255, 128), 255);
  EXPECT_EQ(band_height(256, 128), 128);
}

/// Of numbers whose sum depends on the order in which they are added.
float sum_of(const std::vector<float>& numbers) {
  return sum_over_rows(static_cast<int>(numbers.size()), [&](Rows rows) {
    return std::accumulate(numbers.begin() + rows.first, numbers.begin() + rows.last, 0.F);
  });
}

TEST(Rows, SumsAreAddedUpInTheBandsOrder) {
  std::vector<float> numbers(1024);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = (i % 3 == 0 ? 1e8F : 0.1F) / static_cast<float>(i + 1);
  }
  float expected = 0;
  for (std::size_t first = 0; first < numbers.size(); first += 128) {
    const auto band = numbers.begin() + static_cast<std::ptrdiff_t>(first);
    const float sum = std::accumulate(band, band + 128, 0.F);
    expected = first == 0 ? sum : expected + sum;
  }
  for (int time = 0; time < 100; ++time) ASSERT_EQ(sum_of(numbers), expected);
}

}  // namespace
}  // namespace diminish
