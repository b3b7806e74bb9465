#include "sink/video_file.h"

#include <gmock/gmock.h>

#include <opencv2/videoio.hpp>

#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class Video : public ::testing::Test {
 protected:
  static Image<Bgr> picture(int i) {
    const auto value = static_cast<std::uint8_t>(40 * i);
    return {65, 49, Bgr{value, 100, 50}};
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "a.mp4";
};

TEST_F(Video, HoldsThePicturesInOrder) {
  VideoFile video(file_, 12.5);
  constexpr int count = 6;
  for (int i = 0; i < count; ++i) video.append(picture(i));
  EXPECT_FALSE(std::filesystem::exists(file_)) << "before it is complete";
  EXPECT_EQ(video.finish(), "");

  cv::VideoCapture reader(file_.string());
  EXPECT_EQ(reader.get(cv::CAP_PROP_FPS), 12.5);
  cv::Mat frame;
  for (int i = 0; i < count; ++i) {
    ASSERT_TRUE(reader.read(frame));
    EXPECT_EQ(frame.size(), cv::Size(64, 48)) << "odd columns and rows are dropped";
    const cv::Scalar mean = cv::mean(frame);
    EXPECT_NEAR(mean[0], 40 * i, 6);
    EXPECT_NEAR(mean[1], 100, 6);
    EXPECT_NEAR(mean[2], 50, 6);
  }
  EXPECT_FALSE(reader.read(frame));
}

TEST_F(Video, WithoutAnEndThereIsNone) {
  VideoFile(file_, 30).append(picture(1));
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(Video, SaysWhyThereIsNone) {
  VideoFile video(folder_.path() / "none" / "a.mp4", 30);
  for (int i = 0; i < 3; ++i) video.append(picture(i));
  EXPECT_THAT(video.finish(), AllOf(StartsWith((folder_.path() / "none" / "a.mp4").string()),
                                    HasSubstr("not written: the file cannot be written")));
}

TEST_F(Video, WithoutPicturesThereIsNoneAndNoProblem) {
  EXPECT_EQ(VideoFile(file_, 30).finish(), "");
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

}  // namespace
}  // namespace diminish
