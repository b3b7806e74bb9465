#include "setup/convert/kinect_calibration.h"

#include <gmock/gmock.h>

#include <opencv2/calib3d.hpp>

#include "expect_error.h"
#include "kinect_json.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

const cv::Size hd(1920, 1080), narrow(640, 576);

/// OpenCV's own projection to the whole sensor, 1 wide and high, (0, 0) at its corner.
cv::Point2d on_whole_sensor(const std::array<double, 14>& p, const Eigen::Vector3d& x) {
  const cv::Matx33d matrix(p[2], 0, p[0], 0, p[3], p[1], 0, 0, 1);
  const std::vector<double> distortion = {p[4], p[5], p[13], p[12], p[6], p[7], p[8], p[9]};
  std::vector<cv::Point2d> projected;
  cv::projectPoints(std::vector<cv::Point3d>{{x.x(), x.y(), x.z()}}, cv::Vec3d(), cv::Vec3d(),
                    matrix, distortion, projected);
  return projected[0];
}

void expect_at(const Intrinsics& lens, const Eigen::Vector3d& x, cv::Point2d expected) {
  const auto pixel = Lens(lens).project(x);
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), expected.x, 1e-6);
  EXPECT_NEAR(pixel->y(), expected.y, 1e-6);
}

const std::vector<Eigen::Vector3d> points = {
    {0, 0, 1}, {.2, -.1, 1}, {-.3, .25, 1}, {.4, .3, 1.2}, {-.1, -.35, .9}};

// A pixel of a mode is one, or four, of the sensor's, counted from where the mode begins.
TEST(KinectCalibration, DepthModesAreBinnedAndCropped) {
  const KinectJson json;
  struct Mode {
    cv::Size image;
    double sensor_pixels;  // to a pixel of the mode, each way
    cv::Point2d first;     // of the sensor's pixels
  };
  for (const Mode& mode : {Mode{{640, 576}, 1, {192, 180}},
                           {{320, 288}, 2, {192, 180}},
                           {{1024, 1024}, 1, {0, 0}},
                           {{512, 512}, 2, {0, 0}}}) {
    const auto lens = read_kinect_calibration(json.text(), hd, mode.image).depth;
    EXPECT_EQ(lens.width, mode.image.width);
    for (const Eigen::Vector3d& x : points) {
      const cv::Point2d corner_based = on_whole_sensor(json.depth, x) * 1024;
      expect_at(lens, x,
                {(corner_based.x - mode.first.x) / mode.sensor_pixels - .5,
                 (corner_based.y - mode.first.y) / mode.sensor_pixels - .5});
    }
  }
}

TEST(KinectCalibration, ColourIsThePicturesMiddle) {
  const KinectJson json;
  for (const cv::Size image : {hd, cv::Size(1280, 720), cv::Size(3840, 2160), cv::Size(2048, 1536),
                               cv::Size(4096, 3072)}) {
    const auto lens = read_kinect_calibration(json.text(), image, narrow).color;
    const double full_height = image.width * 3 / 4.;
    for (const Eigen::Vector3d& x : points) {
      const cv::Point2d whole = on_whole_sensor(json.color, x);
      expect_at(lens, x,
                {whole.x * image.width - .5,
                 whole.y * full_height - (full_height - image.height) / 2 - .5});
    }
  }
}

TEST(KinectCalibration, AnEarlyOneIsOfThe16To9Picture) {
  KinectJson wide;
  wide.color_width = 3840;
  wide.color_height = 2160;
  KinectJson full = wide;
  // The same lens, told of the 4:3 picture, of which 16:9 is the middle three quarters.
  full.color_width = 4096;
  full.color_height = 3072;
  full.color[1] = wide.color[1] * .75 + .125;
  full.color[3] = wide.color[3] * .75;
  for (const cv::Size image : {hd, cv::Size(2048, 1536)}) {
    const auto a = read_kinect_calibration(wide.text(), image, narrow).color;
    const auto b = read_kinect_calibration(full.text(), image, narrow).color;
    EXPECT_NEAR(a.cx, b.cx, 1e-9);
    EXPECT_NEAR(a.cy, b.cy, 1e-9);
    EXPECT_NEAR(a.fx, b.fx, 1e-9);
    EXPECT_NEAR(a.fy, b.fy, 1e-9);
  }
}

TEST(KinectCalibration, TheColourSensorIsWhereTheDeviceSays) {
  const KinectJson json;
  const auto transform = read_kinect_calibration(json.text(), hd, narrow).color_from_depth;
  // A point half a metre ahead of the depth sensor, by hand: R x + t.
  const Eigen::Vector3d at = transform * Eigen::Vector3d(0, 0, .5);
  EXPECT_NEAR(at.x(), -.00044814 * .5 - .0320834, 1e-6);
  EXPECT_NEAR(at.y(), .08616032 * .5 - .0022054, 1e-6);
  EXPECT_NEAR(at.z(), .99628121 * .5 + .0038837, 1e-6);
}

TEST(KinectCalibration, WhatIsWrongIsSaid) {
  const auto complaint = [](const std::string& text, cv::Size depth = narrow) {
    return error_of([&] { read_kinect_calibration(text, hd, depth); });
  };
  const std::string good = KinectJson().text();
  const auto with = [&](const std::string& what, const std::string& by) {
    std::string text = good;
    text.replace(text.find(what), what.size(), by);
    return text;
  };
  EXPECT_THAT(complaint("{"), HasSubstr("calibration.json: expected JSON"));
  EXPECT_THAT(complaint("[]"), HasSubstr("expected CalibrationInformation"));
  EXPECT_THAT(complaint("{\"CalibrationInformation\":{\"Cameras\":[]}}"),
              HasSubstr("expected a camera at the location D0"));
  EXPECT_THAT(complaint(good, {640, 480}),
              HasSubstr("expected depth of 320x288, 640x576, 512x512 or 1024x1024, got 640x480"));
  EXPECT_THAT(complaint(with("BrownConrady", "Theta")), HasSubstr("the lens model BrownConrady"));
  EXPECT_THAT(complaint(with("0.5164", "\"x\"")), HasSubstr("14 numbers as ModelParameters"));
  EXPECT_THAT(complaint(with("0.5164", "1e300")), HasSubstr("usual numbers"));
  EXPECT_THAT(complaint(with("0.99999923", "0.9")), HasSubstr("a rotation"));
}

}  // namespace
}  // namespace diminish
