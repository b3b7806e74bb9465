#include "source/stream_list.h"

#include <sstream>

#include "expect_error.h"
#include "paths.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

std::vector<StreamEntry> entries_of(const std::string& text) {
  std::istringstream stream(text);
  return read_stream_list(stream, "color.txt");
}

std::vector<StreamEntry> at(const std::vector<double>& stamps) {
  std::vector<StreamEntry> entries;
  entries.reserve(stamps.size());
  for (const double stamp : stamps) entries.push_back({stamp, "a.png", std::nullopt, 1});
  return entries;
}

TEST(StreamList, ToleratesCommentsBlankLinesAndCarriageReturns) {
  const auto entries = entries_of(
      "# timestamp filename\r\n\r\n 1305031102.175304\trgb/1305031102.175304.png \r\n"
      "#\n1305031102.25  /data/my pictures/b.jpg");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].stamp_s, 1305031102.175304);
  EXPECT_EQ(entries[0].file, "rgb/1305031102.175304.png");
  EXPECT_EQ(entries[0].line, 3);
  EXPECT_EQ(entry_name(entries[0], 0), "1305031102.175304");
  EXPECT_EQ(entries[1].file, "/data/my pictures/b.jpg");
  EXPECT_EQ(describe(entries[1]), "/data/my pictures/b.jpg");
}

TEST(StreamList, MalformedLinesAreNamed) {
  const std::pair<std::string, const char*> cases[] = {
      {"1 a.png\nx b.png\n", "color.txt:2: expected a timestamp, got 'x'"},
      {"nan a.png\n", "color.txt:1: expected a timestamp, got 'nan'"},
      {"inf a.png\n", "color.txt:1: expected a timestamp, got 'inf'"},
      {"1e999 a.png\n", "color.txt:1: expected a timestamp, got '1e999'"},
      {"1,5 a.png\n", "color.txt:1: expected a timestamp, got '1,5'"},
      {"1 a.png\n2\n", "color.txt:2: expected a file's name after the timestamp"},
      {"1 a.png\n2  \t\r\n", "color.txt:2: expected a file's name after the timestamp"},
      {std::string("1 a\0b.png\n", 10), "color.txt:1: expected a file's name, got 'a?b.png'"},
      {"2 a.png\n\n1.5 b.png\n", "color.txt:3: expected a timestamp after 2.000000, got 1.500000"},
      {"2 a.png\n2 b.png\n", "color.txt:2: expected a timestamp after 2.000000, got 2.000000"},
      {"# nothing\n\n", "color.txt: expected at least one line of \"timestamp filename\""},
  };
  for (const auto& [text, message] : cases)
    EXPECT_EQ(error_of([&text = text] { entries_of(text); }), message);
}

TEST(StreamList, LinesOfOneVideoAreItsFrames) {
  const auto entries = entries_of("1 a.mkv\n2 b.MP4\n3 a.mkv\n4 c.png\n5 a.mkv\n");
  EXPECT_EQ(entries[0].frame, 0);
  EXPECT_EQ(entries[1].frame, std::nullopt);  // all of it, see expand_videos
  EXPECT_TRUE(is_video(entries[1].file));
  EXPECT_EQ(entries[2].frame, 1);
  EXPECT_EQ(entries[3].frame, std::nullopt);
  EXPECT_EQ(entries[4].frame, 2);
  EXPECT_EQ(entry_name(entries[4], 4), "000004");
  EXPECT_EQ(describe(entries[4]), "a.mkv frame 2");
}

TEST(StreamList, OneLineOfAVideoStandsForAllItsFrames) {
  const std::string video = testing::source_test_data() + "/depth.mkv";
  const auto entries = expand_videos(entries_of("0.5 a.png\n1 " + video + "\n"), "color.txt");
  ASSERT_EQ(entries.size(), 6U);
  for (int frame = 0; frame < 5; ++frame) {
    const StreamEntry& entry = entries[static_cast<std::size_t>(frame) + 1];
    EXPECT_EQ(entry.frame, frame);
    EXPECT_DOUBLE_EQ(entry.stamp_s, 1 + 0.1 * frame);
    EXPECT_EQ(entry.line, 2);
  }
  EXPECT_THAT(
      error_of([&] { expand_videos(entries_of("1 " + video + "\n1.3 b.png\n"), "color.txt"); }),
      HasSubstr("color.txt:2: expected a timestamp after 1.4"));
  EXPECT_EQ(error_of([&] { expand_videos(entries_of("1 none.mp4\n"), "here/color.txt"); }),
            "here/none.mp4: there is no such file");
}

TEST(StreamList, FindsTheNearestEntryWithinTheTolerance) {
  const auto entries = at({1, 2, 4});
  EXPECT_EQ(nearest_entry(entries, 0.5, 0.5), 0U);
  EXPECT_EQ(nearest_entry(entries, 0.4, 0.5), std::nullopt);
  EXPECT_EQ(nearest_entry(entries, 1.5, 1), 0U);  // the earlier of two
  EXPECT_EQ(nearest_entry(entries, 1.6, 1), 1U);
  EXPECT_EQ(nearest_entry(entries, 2, 0), 1U);
  EXPECT_EQ(nearest_entry(entries, 3, 0.9), std::nullopt);
  EXPECT_EQ(nearest_entry(entries, 9, 5), 2U);
  EXPECT_EQ(nearest_entry(entries, 9, 4.9), std::nullopt);
  EXPECT_EQ(nearest_entry({}, 1, 1), std::nullopt);
  // 1305031102.21 - 1305031102.20 is a little more than 0.01.
  EXPECT_EQ(nearest_entry(at({1305031102.20}), 1305031102.21, 0.01), 0U);
}

TEST(StreamList, MedianPeriod) {
  EXPECT_EQ(median_period_s(at({1, 2, 3, 10})), 1);
  EXPECT_EQ(median_period_s(at({7})), 1.0 / 30);
}

}  // namespace
}  // namespace diminish
