#include <gmock/gmock.h>

#include <opencv2/videoio.hpp>
#include <thread>

#include "core/mat.h"
#include "expect_error.h"
#include "paths.h"
#include "same_pixels.h"
#include "source/tiny_recording.h"

namespace diminish {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

cv::Mat black(int width, int height, int type) {
  return {height, width, type, cv::Scalar::all(0)};
}

const std::string unknown_format =
    "cannot be decoded, expected PNG, JPEG, BMP, TIFF, WebP, PGM or PPM";

TEST(Recording, ReadsTheBundledRecordings) {
  const Recording recording = load_recording(testing::recordings_dir() + "/workbench");
  const auto source = open_recording(recording, {});
  EXPECT_EQ(source->frame_count(), 3U);
  EXPECT_NEAR(source->frames_per_second(), 30, 0.01);
  FrameSet frame;
  std::size_t count = 0;
  for (; source->next(frame); ++count) {
    EXPECT_EQ(frame.index, count);
    EXPECT_EQ(frame.name, fmt::format("{:06}", count));
    EXPECT_THAT(frame.faults, IsEmpty());
    EXPECT_EQ(frame.color.bounds(), recording.rig.color.bounds());
    ASSERT_EQ(frame.rgbd.size(), 2U);
    for (const RgbdFrame& rgbd : frame.rgbd) {
      EXPECT_TRUE(rgbd.available());
      EXPECT_EQ(rgbd.depth.bounds(), recording.rig.rgbd[0].depth.bounds());
      EXPECT_NEAR(rgbd.color_stamp_s, frame.stamp_s + 0.002, 1e-5);
    }
    EXPECT_THAT(frame.masks, IsEmpty());
  }
  EXPECT_EQ(count, 3U);
  EXPECT_FALSE(source->next(frame));
}

TEST(Recording, PixelsArriveAsTheyAre) {
  const auto frames = TinyRecording().read();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[2].color(39, 29), (Bgr{2, 50, 200}));
  EXPECT_EQ(frames[2].rgbd[0].color(0, 0), (Bgr{2, 1, 2}));
  EXPECT_EQ(frames[2].rgbd[0].depth(31, 23), 1002);
  EXPECT_DOUBLE_EQ(frames[2].rgbd[0].depth_stamp_s, 1000.201);
}

TEST(Recording, ImagesWithoutAPartnerInTimeAreMissingNotFaults) {
  const TinyRecording recording;
  recording.write_list("rgbd0_depth", {0, 2});
  const auto frames = recording.read();
  EXPECT_TRUE(frames[0].rgbd[0].available());
  EXPECT_EQ(frames[1].rgbd[0].missing, "rgbd0: no depth image within 0.05 s");
  EXPECT_TRUE(frames[1].rgbd[0].depth.empty());
  EXPECT_EQ(frames[1].rgbd[0].depth_stamp_s, 0);
  EXPECT_THAT(frames[1].faults, IsEmpty());
  EXPECT_TRUE(frames[2].rgbd[0].available());

  Options options;
  options.sync_tolerance_s = 0.15;
  EXPECT_EQ(recording.read(options)[1].rgbd[0].depth(0, 0), 1000);
  options.sync_tolerance_s = 0.0005;
  EXPECT_EQ(recording.read(options)[0].rgbd[0].missing, "rgbd0: no color image within 0.0005 s");
}

TEST(Recording, AnRgbdCameraMayHaveDeliveredNothing) {
  const TinyRecording recording;
  recording.write_list("rgbd0_color", {});
  recording.write_list("rgbd0_depth", {});
  const auto frames = recording.read();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[2].rgbd[0].missing, "rgbd0: no color image within 0.05 s");
  EXPECT_FALSE(frames[2].color.empty());

  recording.write_list("color", {});
  EXPECT_EQ(error_of([&] { recording.open(); }),
            recording.path("color.txt").string() +
                ": expected at least one line of \"timestamp filename\"");
}

TEST(Recording, ASingleFrameHasATolerance) {
  const TinyRecording recording;
  recording.write_list("color", {1});
  EXPECT_EQ(recording.open()->frames_per_second(), 0);
  EXPECT_TRUE(recording.read()[0].rgbd[0].available());
}

TEST(Recording, ABadImageIsAFaultOfItsFrame) {
  const TinyRecording recording;
  recording.write("rgbd0_depth/1.png", black(32, 24, CV_8UC1));
  recording.write("rgbd0_color/2.png", black(32, 25, CV_8UC3));
  recording.write("color/2.png", "no picture");
  const auto frames = recording.read();
  EXPECT_THAT(frames[0].faults, IsEmpty());
  EXPECT_THAT(frames[1].faults,
              ElementsAre("rgbd0_depth/1.png: expected 16-bit one-channel 32x24, got 8-bit "
                          "one-channel 32x24"));
  EXPECT_EQ(frames[1].rgbd[0].missing, "rgbd0: its depth image cannot be used");
  EXPECT_TRUE(frames[1].rgbd[0].depth.empty());
  EXPECT_FALSE(frames[1].color.empty());
  EXPECT_THAT(frames[2].faults, ElementsAre("color/2.png: " + unknown_format,
                                            "rgbd0_color/2.png: expected 32x24, got 32x25"));
  EXPECT_TRUE(frames[2].color.empty());
}

TEST(Recording, EveryWayInWhichADepthImageCanBeBad) {
  const std::pair<cv::Mat, const char*> cases[] = {
      {black(32, 24, CV_8UC3), "got 8-bit 3-channel 32x24"},
      {black(32, 24, CV_16UC3), "got 16-bit 3-channel 32x24"},
      {black(24, 32, CV_16UC1), "got 16-bit one-channel 24x32"},
  };
  for (const auto& [image, message] : cases) {
    const TinyRecording recording;
    recording.write("rgbd0_depth/1.png", image);
    EXPECT_THAT(recording.read()[1].faults, ElementsAre(HasSubstr(message)));
  }
}

TEST(Recording, FilesThatAreCutShortOrGoneAreFaults) {
  const TinyRecording recording;
  std::filesystem::remove(recording.path("rgbd0_depth/0.png"));
  std::filesystem::resize_file(recording.path("rgbd0_depth/1.png"), 90);
  recording.write("rgbd0_depth/2.png", "");
  cv::Mat noise(24, 32, CV_8UC3);
  cv::randu(noise, 0, 255);
  recording.write("rgbd0_color/1.jpg", noise);
  std::filesystem::rename(recording.path("rgbd0_color/1.jpg"), recording.path("rgbd0_color/1.png"));
  EXPECT_THAT(recording.read()[1].faults, ElementsAre("rgbd0_depth/1.png: the file is cut short"));
  std::filesystem::resize_file(recording.path("rgbd0_color/1.png"), 900);
  const auto frames = recording.read();
  EXPECT_THAT(frames[0].faults, ElementsAre("rgbd0_depth/0.png: there is no such file"));
  EXPECT_THAT(frames[1].faults, ElementsAre("rgbd0_color/1.png: the file is cut short",
                                            "rgbd0_depth/1.png: the file is cut short"));
  EXPECT_THAT(frames[2].faults, ElementsAre("rgbd0_depth/2.png: the file is empty"));
}

TEST(Recording, WhatIsWrongInEveryFrameStopsAtTheStart) {
  {
    const TinyRecording recording;
    recording.write("rgbd0_depth/0.png", black(32, 24, CV_8UC1));
    EXPECT_EQ(error_of([&] { recording.open(); }),
              recording.path("rgbd0_depth/0.png").string() +
                  ": expected 16-bit one-channel 32x24, got 8-bit one-channel 32x24");
  }
  {
    const TinyRecording recording;
    std::filesystem::remove(recording.path("color/0.png"));
    recording.write("color/1.png", black(20, 15, CV_8UC3));
    EXPECT_EQ(error_of([&] { recording.open(); }),
              recording.path("color/1.png").string() + ": expected 40x30, got 20x15");
  }
  {
    const TinyRecording recording;
    std::filesystem::remove_all(recording.path("rgbd0_color"));
    EXPECT_EQ(error_of([&] { recording.open(); }),
              recording.path("rgbd0_color.txt").string() +
                  ": none of its 3 images exist, the first being rgbd0_color/0.png");
  }
  {
    const TinyRecording recording;
    std::filesystem::remove(recording.path("rgbd0_depth.txt"));
    EXPECT_EQ(error_of([&] { recording.open(); }),
              recording.path("rgbd0_depth.txt").string() +
                  ": cannot be opened: No such file or directory");
  }
  {
    const TinyRecording recording;
    recording.write("color.txt", "1 color/0.png\n2 color/1.png\n3 other/0.png\n");
    EXPECT_THAT(error_of([&] { recording.open(); }),
                HasSubstr("color.txt:3: expected another name than '0', which line 1 has too"));
  }
}

TEST(Recording, FoldersThatAreNoRecordings) {
  EXPECT_EQ(error_of([] { load_recording("/nowhere"); }),
            "/nowhere: expected a recording's folder");
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { load_recording(folder.path()); }),
              HasSubstr("rig.yaml: cannot be opened"));
}

TEST(Recording, ColorImagesOfOtherKindsAreConverted) {
  const TinyRecording recording;
  recording.write("color/0.png", cv::Mat(30, 40, CV_8UC1, cv::Scalar(77)));
  recording.write("color/1.png", cv::Mat(30, 40, CV_16UC3, cv::Scalar(0x1200, 0x3400, 0xff00)));
  recording.write("color/2.png", cv::Mat(30, 40, CV_8UC4, cv::Scalar(1, 2, 3, 0)));
  const auto frames = recording.read();
  EXPECT_EQ(frames[0].color(0, 0), (Bgr{77, 77, 77}));
  EXPECT_EQ(frames[1].color(0, 0), (Bgr{0x12, 0x34, 0xff}));
  EXPECT_EQ(frames[2].color(0, 0), (Bgr{1, 2, 3}));
}

TEST(Recording, OrientationTagsDoNotTurnImages) {
  const TinyRecording recording;
  cv::Mat image = black(40, 30, CV_8UC3);
  image.rowRange(0, 10).setTo(cv::Scalar::all(255));
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", image, jpeg);
  // EXIF: orientation 3, upside down.
  const std::string exif(
      "\xff\xe1\x00\x22"
      "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x03\0\0\0\0\0\0",
      36);
  jpeg.insert(jpeg.begin() + 2, exif.begin(), exif.end());
  ASSERT_EQ(cv::imdecode(jpeg, cv::IMREAD_COLOR).at<cv::Vec3b>(0, 0)[0], 0) << "not turned";
  recording.write("color/0.png", std::string(jpeg.begin(), jpeg.end()));
  EXPECT_GT(recording.read()[0].color(0, 0).b, 200);
}

TEST(Recording, FramesOfVideos) {
  const TinyRecording recording;
  cv::VideoWriter writer(recording.path("a.avi").string(), cv::CAP_OPENCV_MJPEG,
                         cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10, {40, 30});
  ASSERT_TRUE(writer.isOpened());
  for (int i = 0; i < 5; ++i) writer.write(cv::Mat(30, 40, CV_8UC3, cv::Scalar::all(40 * i)));
  writer.release();
  recording.write("color.txt", "1000 a.avi\n");
  recording.write("rgbd0_depth.txt", "1000.001 " + testing::source_test_data() + "/depth.mkv\n");
  const auto frames = recording.read();
  ASSERT_EQ(frames.size(), 5U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].name, fmt::format("{:06}", i));
    EXPECT_NEAR(frames[i].stamp_s, 1000 + 0.1 * static_cast<double>(i), 1e-9);
    EXPECT_NEAR(frames[i].color(20, 15).g, 40 * static_cast<int>(i), 3);
    EXPECT_THAT(frames[i].faults, IsEmpty());
    // depth.mkv: 1000 * frame + x + 100 * y
    EXPECT_EQ(frames[i].rgbd[0].depth(0, 0), 1000 * i);
    EXPECT_EQ(frames[i].rgbd[0].depth(31, 23), 1000 * i + 2331);
  }
  // Every second frame of the depth video, and timestamps of our own.
  recording.write_list("color", {0, 2});
  EXPECT_EQ(recording.read()[1].rgbd[0].depth(0, 0), 2000);
  // More lines than frames.
  recording.write("color.txt", "1 a.avi\n2 a.avi\n3 a.avi\n4 a.avi\n5 a.avi\n6 a.avi\n");
  EXPECT_THAT(recording.read()[5].faults, ElementsAre("a.avi frame 5: cannot be decoded"));
}

TEST(Recording, SeveralFramesAreReadAtATimeAsOneAfterAnother) {
  const TinyRecording recording;
  recording.write("rgbd0_depth.txt", "1000.001 " + testing::source_test_data() + "/depth.mkv\n");
  recording.write("rgbd0_color/1.png", "no picture");
  recording.write("color/2.png", black(40, 31, CV_8UC3));
  const auto expected = recording.read();
  ASSERT_EQ(expected.size(), 3U);

  const auto source = recording.open();
  std::vector<FrameSet> frames(3);
  for (FrameSet& frame : frames) ASSERT_TRUE(source->begin(frame));
  FrameSet none;
  EXPECT_FALSE(source->begin(none));
  {
    std::vector<std::jthread> readers;
    readers.reserve(frames.size());
    for (FrameSet& frame : frames) readers.emplace_back([&] { source->read_images(frame); });
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].name, expected[i].name);
    EXPECT_EQ(frames[i].faults, expected[i].faults);
    EXPECT_TRUE(testing::same_pixels(frames[i].color, expected[i].color));
    const RgbdFrame& rgbd = frames[i].rgbd[0];
    const RgbdFrame& expected_rgbd = expected[i].rgbd[0];
    EXPECT_EQ(rgbd.missing, expected_rgbd.missing);
    EXPECT_EQ(rgbd.depth_stamp_s, expected_rgbd.depth_stamp_s);
    EXPECT_TRUE(testing::same_pixels(rgbd.color, expected_rgbd.color));
    EXPECT_TRUE(testing::same_pixels(rgbd.depth, expected_rgbd.depth));
  }
  EXPECT_THAT(frames[1].faults, ElementsAre("rgbd0_color/1.png: " + unknown_format));
  EXPECT_EQ(frames[2].rgbd[0].depth(0, 0), 2000) << "the depth video's third frame";
}

TEST(Recording, VideosThatCannotBeDepthStopAtTheStart) {
  const TinyRecording recording;
  cv::VideoWriter writer(recording.path("a.avi").string(), cv::CAP_OPENCV_MJPEG,
                         cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10, {32, 24});
  writer.write(black(32, 24, CV_8UC3));
  writer.release();
  recording.write("rgbd0_depth.txt", "1000 a.avi\n");
  EXPECT_THAT(error_of([&] { recording.open(); }),
              HasSubstr("a.avi frame 0: expected 16-bit one-channel 32x24, got 8-bit 3-channel"));
  recording.write("b.mp4", "no video");
  recording.write("color.txt", "1000 b.mp4\n");
  EXPECT_THAT(error_of([&] { recording.open(); }), HasSubstr("b.mp4: cannot be opened as a video"));
}

TEST(Recording, GivenMasks) {
  const TinyRecording recording;
  recording.write("scene.yaml",
                  "occluders:\n"
                  "  - {name: ball, detector: color_blob, training: training}\n"
                  "  - {name: cup, detector: mask, color: masks/color, rgbd0: masks/rgbd0}\n"
                  "  - {name: box, detector: mask, color: masks/color}\n");
  cv::Mat mask = black(40, 30, CV_8UC3);
  mask.at<cv::Vec3b>(4, 7) = {0, 0, 1};
  recording.write("masks/color/0.png", mask);
  recording.write("masks/color/1.png", black(40, 31, CV_8UC1));
  recording.write("masks/rgbd0/0.png", cv::Mat(24, 32, CV_16UC1, cv::Scalar(1)));
  recording.write("masks/rgbd0/1.png", black(32, 24, CV_8UC1));
  recording.write("masks/rgbd0/2.png", cv::Mat(24, 32, CV_8UC4, cv::Scalar(0, 0, 0, 255)));
  // The RGB-D camera's image of frame 1 is called 2.
  recording.write("rgbd0_color.txt", "1000 rgbd0_color/0.png\n1000.1 rgbd0_color/2.png\n");
  const auto frames = recording.read();
  ASSERT_EQ(frames[0].masks.size(), 2U);
  const GivenMask& cup = frames[0].masks[0];
  EXPECT_EQ(cup.occluder, "cup");
  EXPECT_EQ(cup.color(7, 4), 255);
  EXPECT_EQ(count_nonzero(cup.color, cup.color.bounds()), 1U);
  EXPECT_EQ(cup.rgbd[0], Mask(32, 24, 255));
  EXPECT_EQ(frames[0].masks[1].occluder, "box");
  ASSERT_EQ(frames[0].masks[1].rgbd.size(), 1U);
  EXPECT_TRUE(frames[0].masks[1].rgbd[0].empty());
  EXPECT_THAT(frames[0].faults, IsEmpty());

  const std::string folder = recording.path("masks/color").string();
  EXPECT_TRUE(frames[1].masks[0].color.empty());
  EXPECT_EQ(frames[1].masks[0].rgbd[0], Mask(32, 24, 0));  // black but for its alpha
  EXPECT_THAT(frames[1].faults, ElementsAre(folder + "/1.png: expected 40x30, got 40x31",
                                            folder + "/1.png: expected 40x30, got 40x31"));
  EXPECT_THAT(frames[2].faults, ElementsAre(folder + "/2.png: there is no such file",
                                            folder + "/2.png: there is no such file"));
  // Without a mask of that name, the frame's name counts.
  std::filesystem::remove(recording.path("masks/rgbd0/2.png"));
  EXPECT_EQ(recording.read()[1].masks[0].rgbd[0], Mask(32, 24, 0));
}

TEST(Recording, MaskFoldersMustExist) {
  const TinyRecording recording;
  const std::string occluder = "occluders: [{name: cup, detector: mask, ";
  recording.write("scene.yaml", occluder + "color: nowhere}]\n");
  EXPECT_EQ(error_of([&] { recording.open(); }),
            recording.path("scene.yaml").string() +
                ":1: occluders[0].color: expected a folder, got '" +
                recording.path("nowhere").string() + "'");
  recording.write("scene.yaml", occluder + "color: color, rgbd1: color}]\n");
  EXPECT_THAT(error_of([&] { recording.open(); }),
              HasSubstr("occluders[0].rgbd1: unknown key, expected one of name, detector, color, "
                        "rgbd0"));
  recording.write("scene.yaml", occluder + "rgbd0: color}]\n");
  EXPECT_THAT(error_of([&] { recording.open(); }), HasSubstr("missing key 'color'"));
}

}  // namespace
}  // namespace diminish
