#include "sink/run_statistics.h"

#include <gmock/gmock.h>

namespace diminish {
namespace {

using ::testing::HasSubstr;

TEST(RunStatistics, AddsUpFramesAndLeavesSkippedOnesOutOfTheTimes) {
  RunStatistics statistics;
  FrameReport report;
  report.milliseconds = {1, 2, 3, 4, 5, 6};
  report.mask_pixels = 100;
  report.valid_pixels = 75;
  report.missing_pixels = 25;
  statistics.add(report);
  report.milliseconds = {3, 2, 3, 4, 5, 6};
  report.messages = {"ball: not found"};
  statistics.add(report);
  FrameReport skipped;
  skipped.skipped = true;
  skipped.faults = {"color/000002.jpg: cannot be decoded"};
  statistics.add(skipped);

  EXPECT_EQ(statistics.frames(), 2U);
  EXPECT_EQ(statistics.skipped(), 1U);
  EXPECT_EQ(statistics.faulty(), 1U);
  EXPECT_DOUBLE_EQ(statistics.average_ms(0), 2);
  EXPECT_DOUBLE_EQ(statistics.times()[stage_count].min_ms, 21);
  EXPECT_DOUBLE_EQ(statistics.times()[stage_count].max_ms, 23);
  const std::string table = statistics.table();
  EXPECT_THAT(table, HasSubstr("75.0 % seen, 25.0 % not"));
  EXPECT_THAT(table, HasSubstr("1 of 3 frames: ball: not found"));
  EXPECT_THAT(table, HasSubstr("1 frames skipped"));
}

}  // namespace
}  // namespace diminish
