#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "core/mat.h"
#include "diminish/frame_source.h"
#include "expect_error.h"
#include "kinect_json.h"
#include "setup/convert/convert.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Big-endian, in as many bytes as asked for.
std::string number(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = bytes; i-- > 0;) text += static_cast<char>(value >> 8 * i);
  return text;
}
/// An element of EBML (RFC 8794): its id, its size in eight bytes, its content.
std::string element(std::uint32_t id, const std::string& content) {
  const int id_bytes = id > 0xFFFFFF ? 4 : id > 0xFFFF ? 3 : id > 0xFF ? 2 : 1;
  return number(id, id_bytes) + number(0x0100000000000000U | content.size(), 8) + content;
}
std::string element(std::uint32_t id, std::uint64_t value) {
  return element(id, number(value, 8));
}

/// A file as k4arecorder writes it, after Matroska's specification (RFC 9559).
class Mkv {
 public:
  std::string calibration = KinectJson().text();
  std::string color_fourcc = "MJPG";
  cv::Size color_size{64, 36}, depth_size{320, 288};
  bool has_depth = true;

  void add(int track, std::uint64_t time_us, const std::string& bytes) {
    clusters_ += element(
        0x1F43B675, element(0xE7, time_us) + element(0xA3, number(0x80U | track, 1) + number(0, 2) +
                                                               number(0x80, 1) + bytes));
  }
  std::string bytes() const {
    std::string tracks = track(1, "COLOR", color_fourcc, color_size);
    if (has_depth) tracks += track(2, "DEPTH", "b16g", depth_size);
    tracks += track(3, "IR", "b16g", depth_size);
    return element(0x1A45DFA3, element(0x4282, std::string("matroska"))) +
           element(0x18538067,
                   element(0x1549A966, element(0x2AD7B1, 1000) + element(0x7BA9, "Azure Kinect")) +
                       element(0x1654AE6B, tracks) +
                       element(0x1941A469,
                               element(0x61A7, element(0x466E, std::string("calibration.json")) +
                                                   element(0x4660, "application/octet-stream") +
                                                   element(0x46AE, 77) +
                                                   element(0x465C, calibration))) +
                       element(0x1254C367,
                               tag(0x63C5, 1001, "K4A_COLOR_TRACK", "1001") +
                                   tag(0x63C6, 77, "K4A_CALIBRATION_FILE", "calibration.json")) +
                       clusters_);
  }

 private:
  static std::string element(std::uint32_t id, const std::string& content) {
    return diminish::element(id, content);
  }
  static std::string element(std::uint32_t id, const char* content) {
    return diminish::element(id, std::string(content));
  }
  static std::string element(std::uint32_t id, std::uint64_t value) {
    return diminish::element(id, value);
  }
  static std::string tag(std::uint32_t target, std::uint64_t uid, const char* name,
                         const char* value) {
    return element(0x7373, element(0x63C0, element(target, uid)) +
                               element(0x67C8, element(0x45A3, name) + element(0x4487, value)));
  }
  static std::string little(std::uint64_t value, int bytes) {
    const std::string text = number(value, bytes);
    return {text.rbegin(), text.rend()};
  }
  static std::string track(std::uint64_t index, const char* name, const std::string& fourcc,
                           cv::Size size) {
    const auto width = static_cast<std::uint64_t>(size.width);
    const auto height = static_cast<std::uint64_t>(size.height);
    const std::string header = little(40, 4) + little(width, 4) + little(height, 4) + little(1, 2) +
                               little(16, 2) + fourcc + std::string(20, '\0');
    return element(0xAE, element(0xD7, index) + element(0x73C5, 1000 + index) + element(0x83, 1) +
                             element(0x536E, name) + element(0x86, "V_MS/VFW/FOURCC") +
                             element(0x63A2, header) +
                             element(0xE0, element(0xB0, width) + element(0xBA, height)));
  }

  std::string clusters_;
};

std::string jpeg(cv::Size size, int shade) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", cv::Mat(size, CV_8UC3, cv::Scalar(30, 60, shade)), bytes);
  return {bytes.begin(), bytes.end()};
}
std::uint16_t depth_at(std::size_t i, int frame) {
  return static_cast<std::uint16_t>(i % 7 == 0 ? 0
                                               : 500 + i % 4000 + static_cast<std::size_t>(frame));
}
std::string big_endian_depth(cv::Size size, int frame) {
  std::string bytes;
  for (int i = 0; i < size.area(); ++i) {
    bytes += number(depth_at(static_cast<std::size_t>(i), frame), 2);
  }
  return bytes;
}

TEST(ConvertKinect, ARecordersFileBecomesARecordingThatRuns) {
  Mkv mkv;
  for (int i = 0; i < 3; ++i) {
    const auto time_us = static_cast<std::uint64_t>(2'000'000 + 33'333 * i);
    mkv.add(1, time_us, jpeg(mkv.color_size, 50 * i));
    mkv.add(2, time_us + 100, big_endian_depth(mkv.depth_size, i));
    mkv.add(3, time_us + 100, big_endian_depth(mkv.depth_size, 900));  // infrared
  }
  const TemporaryFolder folder;
  const auto file = folder.write("a.mkv", mkv.bytes());
  ASSERT_TRUE(is_matroska(file));
  const auto made = folder.path() / "made";
  const Conversion conversion = convert_kinect(file, made);
  EXPECT_EQ(conversion.left_out, 0U);
  EXPECT_THAT(conversion.problems, IsEmpty());
  const Recording recording = load_recording(made);
  EXPECT_EQ(recording.rig.color.lens_model, LensModel::rational);
  EXPECT_NEAR(recording.rig.color.fx, .478 * 64, 1e-3);
  ASSERT_EQ(recording.rig.rgbd.size(), 1U);
  EXPECT_NEAR(recording.rig.rgbd[0].depth.cx, .5164 * 512 - 96 - .5, 1e-3);
  EXPECT_NEAR(recording.rig.rgbd[0].depth.cy, .5032 * 512 - 90 - .5, 1e-3);
  EXPECT_NEAR(recording.rig.rgbd[0].color_from_depth.translation.x(), -.0320834, 1e-7);
  const auto source = open_recording(recording, {});
  int frames = 0;
  for (FrameSet frame; source->next(frame); ++frames) {
    EXPECT_THAT(frame.faults, IsEmpty());
    EXPECT_NEAR(frame.stamp_s, 2 + .033333 * frames, 1e-6);
    EXPECT_NEAR(frame.rgbd[0].depth_stamp_s, 2.0001 + .033333 * frames, 1e-6);
    EXPECT_NEAR(frame.color.view()(5, 5).r, 50 * frames, 2);
    const auto& depth = frame.rgbd[0].depth.own();
    ASSERT_EQ(depth.size(), 320U * 288);
    for (std::size_t i = 0; i < depth.size(); ++i) {
      ASSERT_EQ(depth.data()[i], depth_at(i, frames)) << i;
    }
  }
  EXPECT_EQ(frames, 3);
}

TEST(ConvertKinect, WhatIsBrokenIsLeftOutAndCounted) {
  Mkv mkv;
  mkv.add(1, 1000, jpeg(mkv.color_size, 9));
  mkv.add(2, 1000, big_endian_depth(mkv.depth_size, 0));
  mkv.add(1, 2000, "no picture");
  mkv.add(1, 3000, jpeg({32, 32}, 9));
  mkv.add(2, 2000, "short");
  mkv.add(2, 3000, big_endian_depth(mkv.depth_size, 0));
  const TemporaryFolder folder;
  const Conversion conversion =
      convert_kinect(folder.write("a.mkv", mkv.bytes()), folder.path() / "made");
  EXPECT_EQ(conversion.left_out, 3U);
  EXPECT_THAT(conversion.problems, ::testing::Contains("expected a JPEG of 64x36").Times(2));
  EXPECT_THAT(conversion.problems, ::testing::Contains("expected 184320 bytes of depth, got 5"));
  EXPECT_EQ(conversion.streams[2].images, 2U);
}

TEST(ConvertKinect, OtherFilesAreRefused) {
  const TemporaryFolder folder;
  const auto complaint = [&](Mkv mkv) {
    mkv.add(1, 1000, jpeg(mkv.color_size, 9));
    const auto file = folder.write("a.mkv", mkv.bytes());
    return error_of([&] { convert_kinect(file, folder.path() / "made"); });
  };
  Mkv no_depth;
  no_depth.has_depth = false;
  EXPECT_THAT(complaint(no_depth), HasSubstr("a.mkv: expected an Azure Kinect's recording with the "
                                             "track DEPTH"));
  Mkv yuv;
  yuv.color_fourcc = "YUY2";
  EXPECT_THAT(complaint(yuv), HasSubstr("a.mkv: expected colour as MJPEG"));
  Mkv other;
  other.calibration = "{}";
  EXPECT_THAT(complaint(other), HasSubstr("a.mkv: calibration.json: expected CalibrationInfor"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "made"));
  const auto text = folder.write("b.mkv", "\x1A\x45\xDF\xA3 but no more");
  EXPECT_THAT(error_of([&] { convert_kinect(text, folder.path() / "made"); }),
              HasSubstr("b.mkv: expected"));
}

}  // namespace
}  // namespace diminish
