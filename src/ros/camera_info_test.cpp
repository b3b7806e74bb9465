#include "ros/camera_info.h"

#include <gmock/gmock.h>

#include "expect_error.h"

namespace diminish::ros {
namespace {

using ::testing::HasSubstr;

Intrinsics lens(LensModel model) {
  Intrinsics camera{.width = 640, .height = 480, .fx = 600, .fy = 601, .cx = 320, .cy = 240};
  camera.lens_model = model;
  for (std::size_t i = 0; i < coefficient_count(model); ++i) {
    camera.distortion[i] = .01 * static_cast<double>(i + 1);
  }
  return camera;
}

TEST(CameraInfo, EachLensComesBack) {
  for (const LensModel model : {LensModel::plumb_bob, LensModel::rational, LensModel::fisheye}) {
    EXPECT_EQ(intrinsics_of(camera_info(lens(model)), false), lens(model));
  }
}

TEST(CameraInfo, ACameraWithoutDistortionNeedsNoModel) {
  CameraInfoMessage info = camera_info(lens(LensModel::plumb_bob));
  info.distortion_model = "";
  info.d.clear();
  EXPECT_EQ(intrinsics_of(info, false).distortion, (std::array<double, 8>{}));
  // As RealSense names the lens of its depth images.
  info.distortion_model = "inverse_brown_conrady";
  info.d.assign(5, 0);
  EXPECT_EQ(intrinsics_of(info, false).fx, 600);
}

TEST(CameraInfo, RectifiedImagesHaveTheProjectionsLens) {
  CameraInfoMessage info = camera_info(lens(LensModel::plumb_bob));
  info.p[0] = 500;
  info.p[2] = 300;
  const Intrinsics camera = intrinsics_of(info, true);
  EXPECT_EQ(camera.fx, 500);
  EXPECT_EQ(camera.cx, 300);
  EXPECT_EQ(camera.distortion, (std::array<double, 8>{}));
  info.p[0] = 0;  // some drivers leave it out
  EXPECT_EQ(intrinsics_of(info, true).fx, 600);
}

TEST(CameraInfo, PartsAndBinningAreFollowed) {
  CameraInfoMessage info = camera_info(lens(LensModel::plumb_bob));
  info.roi_x = 20;
  info.roi_y = 40;
  info.roi_width = 400;
  info.roi_height = 200;
  info.binning_x = info.binning_y = 2;
  const Intrinsics camera = intrinsics_of(info, false);
  EXPECT_EQ(camera.width, 200);
  EXPECT_EQ(camera.height, 100);
  EXPECT_EQ(camera.fx, 300);
  EXPECT_EQ(camera.cx, 150);
  EXPECT_EQ(camera.cy, 100);
}

TEST(CameraInfo, WhatIsNoLensIsRefused) {
  CameraInfoMessage info = camera_info(lens(LensModel::plumb_bob));
  info.distortion_model = "brown";
  EXPECT_THAT(error_of([&] { intrinsics_of(info, false); }), HasSubstr("got 'brown'"));
  info = camera_info(lens(LensModel::rational));
  info.d.resize(12, .1);
  EXPECT_THAT(error_of([&] { intrinsics_of(info, false); }),
              HasSubstr("expected 8 coefficients of rational_polynomial, got 12"));
  info = CameraInfoMessage{};
  info.width = 640;
  info.height = 480;
  EXPECT_THAT(error_of([&] { intrinsics_of(info, false); }), HasSubstr("not calibrated"));
  info.width = 0;
  EXPECT_THAT(error_of([&] { intrinsics_of(info, false); }), HasSubstr("got 0x480"));
}

}  // namespace
}  // namespace diminish::ros
