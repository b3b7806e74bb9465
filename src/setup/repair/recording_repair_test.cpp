#include "setup/repair/recording_repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "diminish/frame_source.h"
#include "expect_error.h"
#include "source/tiny_recording.h"

namespace diminish {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class RepairTest : public ::testing::Test {
 protected:
  RecordingRepair repair() const { return repair_recording(recording.path("")); }
  void append(const std::string& list, const std::string& text) const {
    std::ofstream(recording.path(list), std::ios::app) << text;
  }
  void cut(const std::string& file) const {
    fs::resize_file(recording.path(file), fs::file_size(recording.path(file)) - 20);
  }
  std::string text_of(const std::string& file) const {
    std::ifstream stream(recording.path(file));
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  TinyRecording recording;
};

TEST_F(RepairTest, AWholeRecordingStaysAsItIs) {
  const std::string before = text_of("color.txt");
  EXPECT_FALSE(repair().was_needed());
  EXPECT_EQ(text_of("color.txt"), before);
  EXPECT_FALSE(fs::exists(recording.path("color.txt.before")));
}

TEST_F(RepairTest, WhatCannotBeReadIsLeftOut) {
  cut("color/2.png");                               // the power failed
  fs::remove(recording.path("rgbd0_color/0.png"));  // never written
  recording.write("rgbd0_depth/1.png", cv::Mat(10, 10, CV_16UC1, cv::Scalar(1)));
  append("rgbd0_depth.txt", "1000.2");  // torn
  append("rgbd0_color.txt", "1000.1 rgbd0_color/1.png\n");
  const std::string before = text_of("color.txt");
  const RecordingRepair done = repair();
  ASSERT_EQ(done.lists.size(), 3U);
  EXPECT_EQ(done.lists[0].kept, 2U);
  EXPECT_THAT(done.lists[0].left_out, ElementsAre(HasSubstr("line 4: color/2.png: ")));
  EXPECT_EQ(done.lists[1].kept, 2U);
  EXPECT_THAT(done.lists[1].left_out, ElementsAre(HasSubstr("line 2: rgbd0_color/0.png: "),
                                                  HasSubstr("line 5: expected a timestamp after")));
  EXPECT_EQ(done.lists[2].kept, 2U);
  EXPECT_THAT(done.lists[2].left_out, ElementsAre(HasSubstr("line 3: rgbd0_depth/1.png: "),
                                                  HasSubstr("line 5: expected a timestamp and")));
  EXPECT_EQ(text_of("color.txt.before"), before);

  // What is left is read without a fault, and is whole.
  const Recording whole = load_recording(recording.path(""));
  const auto source = open_recording(whole, {});
  FrameSet frame;
  std::size_t frames = 0;
  for (; source->next(frame); ++frames) EXPECT_TRUE(frame.faults.empty());
  EXPECT_EQ(frames, 2U);
  EXPECT_FALSE(repair().was_needed());
  EXPECT_EQ(text_of("color.txt.before"), before);
}

TEST_F(RepairTest, FilesThatWereBegunAreDeleted) {
  const fs::path begun = recording.path("color/.3.partial.png");
  std::ofstream(begun) << "half an image";
  std::ofstream(recording.path("color/.hidden.png")) << "somebody else's";
  EXPECT_THAT(repair().deleted, ElementsAre(begun));
  EXPECT_FALSE(fs::exists(begun));
  EXPECT_TRUE(fs::exists(recording.path("color/.hidden.png")));
}

TEST_F(RepairTest, WhatCannotBeRepairedIsOneLine) {
  const std::string before = text_of("color.txt");
  for (const char* image : {"color/0.png", "color/1.png", "color/2.png"}) cut(image);
  EXPECT_THAT(error_of([&] { repair(); }), HasSubstr("color.txt: none of its images"));
  EXPECT_EQ(text_of("color.txt.before"), before);
  fs::remove(recording.path("color.txt"));
  EXPECT_THAT(error_of([&] { repair(); }), HasSubstr("color.txt: cannot be read"));
  fs::remove(recording.path("rig.yaml"));
  EXPECT_THAT(error_of([&] { repair(); }), HasSubstr("rig.yaml"));
}

}  // namespace
}  // namespace diminish
