#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "diminish/frame_source.h"
#include "expect_error.h"
#include "setup/convert/convert.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

TEST(ConvertTum, AFolderBecomesARecordingThatRuns) {
  const TemporaryFolder folder;
  std::string rgb = "# color images\n";
  std::string depth = "# depth maps\n";
  std::filesystem::create_directories(folder.path() / "tum/rgb");
  std::filesystem::create_directories(folder.path() / "tum/depth");
  for (int i = 0; i < 3; ++i) {
    const std::string stamp = "1305031102.1" + std::to_string(i);
    rgb += stamp + "0000 rgb/" + stamp + ".png\n";
    depth += stamp + "2000 depth/" + stamp + ".png\n";
    cv::imwrite((folder.path() / "tum/rgb" / (stamp + ".png")).string(),
                cv::Mat(480, 640, CV_8UC3, cv::Scalar(10, 20, 30 + i)));
    cv::imwrite((folder.path() / "tum/depth" / (stamp + ".png")).string(),
                cv::Mat(480, 640, CV_16UC1, cv::Scalar(5000 + i)));
  }
  folder.write("tum/rgb.txt", rgb);
  EXPECT_FALSE(is_tum_folder(folder.path() / "tum"));
  folder.write("tum/depth.txt", depth);
  ASSERT_TRUE(is_tum_folder(folder.path() / "tum"));
  const auto made = folder.path() / "made";
  const Conversion conversion = convert_tum(folder.path() / "tum", made, tum_lens());
  ASSERT_EQ(conversion.streams.size(), 3U);
  EXPECT_EQ(conversion.streams[0].images, 3U);
  const Recording recording = load_recording(made);
  EXPECT_NEAR(recording.rig.rgbd[0].depth_unit_m, 1 / 5000., 1e-12);
  const auto source = open_recording(recording, {});
  int frames = 0;
  for (FrameSet frame; source->next(frame); ++frames) {
    EXPECT_EQ(frame.color.view()(9, 9), (Bgr{10, 20, static_cast<std::uint8_t>(30 + frames)}));
    ASSERT_TRUE(frame.rgbd[0].available()) << frame.rgbd[0].missing;
    EXPECT_EQ(frame.rgbd[0].depth.view()(9, 9), 5000 + frames);
  }
  EXPECT_EQ(frames, 3);
}

TEST(ConvertTum, FilesElsewhereAreRefused) {
  const TemporaryFolder folder;
  folder.write("tum/rgb.txt", "1.0 ../secret.png\n");
  folder.write("tum/depth.txt", "1.0 depth/a.png\n");
  EXPECT_THAT(
      error_of([&] { convert_tum(folder.path() / "tum", folder.path() / "m", tum_lens()); }),
      HasSubstr("rgb.txt: expected files in the folder, got ../secret.png"));
}

}  // namespace
}  // namespace diminish
