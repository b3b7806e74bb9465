#include "sink/run_statistics.h"

#include <gmock/gmock.h>

namespace diminish {
namespace {

using ::testing::HasSubstr;

TEST(RunStatistics, AddsUpFramesAndLeavesSkippedOnesOutOfTheTimes) {
  RunStatistics statistics;
  FrameReport report;
  report.milliseconds = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  report.frame_ms = 60;
  report.mask_pixels = 100;
  report.valid_pixels = 75;
  report.missing_pixels = 25;
  statistics.add(report);
  report.milliseconds[0] = 3;
  report.frame_ms = 62;
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
  EXPECT_DOUBLE_EQ(statistics.times()[whole_frame_row].min_ms, 60);
  EXPECT_DOUBLE_EQ(statistics.times()[whole_frame_row].max_ms, 62);
  // As the paper sums stages up: poses and detection, ..., inpainting.
  EXPECT_DOUBLE_EQ(statistics.average_ms(stage_count), 4);
  EXPECT_DOUBLE_EQ(statistics.average_ms(stage_count + 1), 63);
  EXPECT_DOUBLE_EQ(statistics.average_ms(stage_count + 2), 27);
  EXPECT_DOUBLE_EQ(statistics.average_ms(stage_count + 3), 13);
  EXPECT_DOUBLE_EQ(statistics.average_ms(stage_count + 4), 14);
  const std::string table = statistics.table();
  EXPECT_THAT(table, HasSubstr("truly seen 75.0 %, invented 25.0 %"));
  EXPECT_FALSE(statistics.remembered_ages());
  EXPECT_THAT(table, HasSubstr("1 of 3 frames: ball: not found"));
  EXPECT_THAT(table, HasSubstr("1 frames skipped"));
}

// Also where a frame says it of several things.
TEST(RunStatistics, CountsMessagesThatDifferInNumbersTogether) {
  RunStatistics statistics;
  for (int i = 0; i < 1000; ++i) {
    FrameReport report;
    report.messages = {"rgbd0: no depth image within 0.02 s of " + std::to_string(1000 + i),
                       "rgbd0: no depth image within 0.02 s of " + std::to_string(5000 + i),
                       "ball: not found"};
    statistics.add(report);
  }
  const std::map<std::string, std::size_t> expected{
      {"ball: not found", 1000}, {"rgbd0: no depth image within 0.02 s of 1000", 1000}};
  EXPECT_EQ(statistics.messages(), expected);
  EXPECT_THAT(statistics.table(), HasSubstr("1000 of 1000 frames: rgbd0: no depth image"));
}

TEST(RunStatistics, SaysHowOldWhatIsRememberedIs) {
  RunStatistics statistics;
  FrameReport report;
  report.mask_pixels = 100;
  statistics.add(report);
  report.valid_pixels = 80;
  report.remembered_pixels = 30;
  for (const double age_s : {2., 7., 4.}) {
    report.memory.median_age_s = age_s;
    report.memory.oldest_age_s = 2 * age_s;
    statistics.add(report);
  }
  EXPECT_DOUBLE_EQ(statistics.remembered_ages()->median_s, 4);
  EXPECT_DOUBLE_EQ(statistics.remembered_ages()->oldest_s, 14);
  EXPECT_THAT(statistics.table(),
              HasSubstr("truly seen 37.5 %, remembered 22.5 %, invented 40.0 %\nRemembered pixels "
                        "were seen 4.0 s before (median), the oldest 14.0 s"));
}

}  // namespace
}  // namespace diminish
