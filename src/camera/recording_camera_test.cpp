#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <thread>

#include "diminish/camera_source.h"
#include "diminish/frame_source.h"
#include "expect_error.h"
#include "source/tiny_recording.h"

namespace diminish {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

/// An image is left out when it is two of these periods late, 0.4 s: no busy machine is.
const std::string slowly = "?rate=0.5";

class RecordingCamera : public ::testing::Test {
 protected:
  std::unique_ptr<CameraSource> open(const std::string& name, const std::string& parameters) {
    return open_camera("recording:" + recording_.path("").string() + parameters,
                       {name, nullptr, epoch_s_});
  }

  /// All images up to `most`, waiting for each.
  static std::vector<CameraImage> read_all(CameraSource& camera, std::size_t most) {
    std::vector<CameraImage> images;
    while (images.size() < most) {
      CameraImage image;
      const auto status = camera.read(image, milliseconds(1000));
      if (status == CameraSource::Status::end) break;
      if (status == CameraSource::Status::image) images.push_back(std::move(image));
    }
    return images;
  }

  TinyRecording recording_;
  double epoch_s_ = monotonic_now_s();
};

TEST_F(RecordingCamera, DeliversEachImageNotBeforeItsTime) {
  const auto camera = open("color", slowly);
  for (int i = 0; i < 3; ++i) {
    CameraImage image;
    ASSERT_EQ(camera->read(image, milliseconds(1000)), CameraSource::Status::image);
    EXPECT_GE(monotonic_now_s(), image.stamp_s);
    EXPECT_NEAR(image.stamp_s, epoch_s_ + 0.1 * i / 0.5, 1e-6);
    EXPECT_EQ(image.sensor, Sensor::color);
    EXPECT_EQ(image.color(0, 0), (Bgr{static_cast<std::uint8_t>(i), 50, 200}));
  }
  CameraImage image;
  EXPECT_EQ(camera->read(image, milliseconds(10)), CameraSource::Status::end);
}

TEST_F(RecordingCamera, AnRgbdCameraDeliversBothSensorsOnTheRecordingsClock) {
  const auto camera = open("rgbd0", slowly);
  const std::vector<CameraImage> images = read_all(*camera, 10);
  std::map<Sensor, int> counts;
  for (const CameraImage& image : images) {
    const int i = counts[image.sensor]++;
    EXPECT_NEAR(image.stamp_s, epoch_s_ + (0.1 * i + 0.001) / 0.5, 1e-6);
    const bool is_depth = image.sensor == Sensor::depth;
    EXPECT_EQ(is_depth ? image.depth(3, 3) - 1000 : image.color(3, 3).b, i);
  }
  EXPECT_EQ(counts[Sensor::color], 3);
  EXPECT_EQ(counts[Sensor::depth], 3);
}

TEST_F(RecordingCamera, ALoopGoesOnWithoutAGapInTime) {
  const auto camera = open("color", "?loop&rate=10");
  const std::vector<CameraImage> images = read_all(*camera, 8);
  ASSERT_EQ(images.size(), 8U);
  // A busy machine may come too late for one: that is counted.
  const auto place = [&](const CameraImage& image) {
    return std::lround((image.stamp_s - epoch_s_) / 0.01);
  };
  for (const CameraImage& image : images) {
    EXPECT_NEAR(image.stamp_s, epoch_s_ + 0.01 * static_cast<double>(place(image)), 1e-6);
    EXPECT_EQ(image.color(0, 0).b, place(image) % 3);
  }
  EXPECT_EQ(place(images.back()), 7 + static_cast<long>(camera->dropped()));
}

TEST_F(RecordingCamera, LoopsInStepShowTheSameMomentWheneverTheyBegin) {
  constexpr double lap_s = 0.03;
  for (const double later_s : {0., 0.007, 0.021}) {
    epoch_s_ = monotonic_now_s() + later_s;
    const auto camera = open("color", "?loop&rate=10&in-step");
    for (const CameraImage& image : read_all(*camera, 4)) {
      const double in_lap = std::fmod(image.stamp_s + 1e-6, lap_s) / lap_s;
      EXPECT_EQ(image.color(0, 0).b, static_cast<int>(3 * in_lap));
    }
  }
}

TEST_F(RecordingCamera, ALoopReadsAnImageWhenItsTimeComesAndKeepsItIfItIsShort) {
  const auto camera = open("color", "?loop&rate=2");
  recording_.write("color/2.png", cv::Mat(30, 40, CV_8UC3, cv::Scalar(100, 50, 200)));
  // A busy machine may come too late for images before it: its time tells which one it is.
  const auto next_third = [&] {
    while (true) {
      const CameraImage image = read_all(*camera, 1).at(0);
      if (std::lround((image.stamp_s - epoch_s_) / 0.05) % 3 == 2) return image.color(0, 0).b;
    }
  };
  EXPECT_EQ(next_third(), 100);
  std::filesystem::remove_all(recording_.path("color"));
  EXPECT_EQ(next_third(), 100);
}

TEST_F(RecordingCamera, WhatIsLongOverdueIsLeftOutAndCounted) {
  const auto camera = open("color", "?loop&rate=100");
  std::this_thread::sleep_for(milliseconds(100));
  CameraImage image;
  ASSERT_EQ(camera->read(image, milliseconds(1000)), CameraSource::Status::image);
  EXPECT_GE(camera->dropped(), 50U);
  EXPECT_GT(image.stamp_s, epoch_s_ + 0.05);
}

TEST_F(RecordingCamera, ADamagedImageIsAFault) {
  recording_.write("color/1.png", "no picture");
  for (const char* parameters : {"?rate=0.5", "?rate=0.5&loop"}) {
    const auto camera = open("color", parameters);
    const std::vector<CameraImage> images = read_all(*camera, 3);
    ASSERT_EQ(images.size(), 3U);
    EXPECT_EQ(images[0].fault, "");
    EXPECT_THAT(images[1].fault, HasSubstr("color/1.png"));
    EXPECT_EQ(images[2].fault, "");
    epoch_s_ = monotonic_now_s();
  }
}

TEST_F(RecordingCamera, ComplaintsNameWhatIsWrong) {
  EXPECT_THAT(error_of([&] { open("color", "?camera=rgbd7"); }),
              HasSubstr("the recording has no camera 'rgbd7'"));
  EXPECT_THAT(error_of([&] { open("color", "?rate=0"); }), HasSubstr("rate: expected a number"));
  EXPECT_THAT(error_of([&] { open("color", "?lop"); }), HasSubstr("unknown parameter 'lop'"));
  EXPECT_THAT(error_of([] {
                open_camera("recording:/nowhere", {"color", nullptr, 0});
              }),
              HasSubstr("/nowhere/rig.yaml"));
}

}  // namespace
}  // namespace diminish
