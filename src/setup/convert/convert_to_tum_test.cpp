#include <gmock/gmock.h>

#include <fstream>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <sstream>

#include "core/mat.h"
#include "diminish/frame_source.h"
#include "expect_error.h"
#include "paths.h"
#include "setup/convert/convert.h"
#include "setup/convert/tum_format.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

TEST(ConvertToTum, WhatCameFromOneIsTheSameAgain) {
  const TemporaryFolder folder;
  const auto tum = folder.path() / "tum";
  std::string rgb, depth;
  std::mt19937 random(1);
  for (int i = 0; i < 3; ++i) {
    const std::string name = "10.00000" + std::to_string(i) + ".png";
    std::filesystem::create_directories(tum / "rgb");
    std::filesystem::create_directories(tum / "depth");
    cv::Mat color(48, 64, CV_8UC3), range(48, 64, CV_16UC1);
    for (auto it = color.begin<cv::Vec3b>(); it != color.end<cv::Vec3b>(); ++it) {
      *it = {static_cast<uchar>(random()), static_cast<uchar>(random()), 9};
    }
    for (auto it = range.begin<std::uint16_t>(); it != range.end<std::uint16_t>(); ++it) {
      *it = static_cast<std::uint16_t>(random());
    }
    cv::imwrite((tum / "rgb" / name).string(), color);
    cv::imwrite((tum / "depth" / name).string(), range);
    rgb += "10.00000" + std::to_string(i) + " rgb/" + name + "\n";
    depth += "10.00000" + std::to_string(i) + " depth/" + name + "\n";
  }
  folder.write("tum/rgb.txt", rgb);
  folder.write("tum/depth.txt", depth);
  const Intrinsics lens{.width = 64, .height = 48, .fx = 55.5, .fy = 56.25, .cx = 31, .cy = 24};
  convert_tum(tum, folder.path() / "recording", lens);
  const Conversion back =
      convert_to_tum(folder.path() / "recording", folder.path() / "back", "rgbd0");
  EXPECT_EQ(back.left_out, 0U);
  ASSERT_EQ(back.streams.size(), 2U);
  EXPECT_EQ(back.streams[0].images, 3U);
  for (const char* file : {"rgb/10.000000.png", "rgb/10.000002.png", "depth/10.000001.png"}) {
    EXPECT_EQ(text_of(tum / file), text_of(folder.path() / "back" / file)) << file;
  }
  EXPECT_TRUE(is_tum_folder(folder.path() / "back"));
  EXPECT_EQ(read_tum_camera(folder.path() / "back"), lens);
  EXPECT_EQ(read_tum_camera(tum), std::nullopt);
}

/// OpenCV's own projection.
cv::Point2d project(const Intrinsics& lens, const RigidTransform& sensor_from_point,
                    const Eigen::Vector3d& point) {
  cv::Matx33d rotation;
  cv::eigen2cv(sensor_from_point.rotation, rotation);
  cv::Vec3d axis;
  cv::Rodrigues(rotation, axis);
  const Eigen::Vector3d& t = sensor_from_point.translation;
  const auto& d = lens.distortion;
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(std::vector<cv::Point3d>{{point.x(), point.y(), point.z()}}, axis,
                    cv::Vec3d(t.x(), t.y(), t.z()),
                    cv::Matx33d(lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1),
                    std::vector<double>(d.begin(), d.begin() + 5), pixels);
  return pixels[0];
}

TEST(ConvertToTum, SensorsThatAreTwoAreRegistered) {
  const auto original = std::filesystem::path(testing::recordings_dir()) / "calendar";
  const TemporaryFolder folder;
  const auto made = folder.path() / "tum";
  const Conversion conversion = convert_to_tum(original, made, "rgbd0");
  const Recording recording = load_recording(original);
  const RgbdCamera& camera = recording.rig.rgbd[0];
  const auto source = open_recording(recording, {});
  FrameSet frame;
  ASSERT_TRUE(source->next(frame));
  EXPECT_GT(conversion.streams[1].images, 1U);
  const auto path = [&](const char* name, double stamp_s) {
    char file[64];
    std::snprintf(file, sizeof file, "%s/%.6f.png", name, stamp_s);
    return (made / file).string();
  };
  const cv::Mat depth =
      cv::imread(path("depth", frame.rgbd[0].depth_stamp_s), cv::IMREAD_UNCHANGED);
  const cv::Mat color = cv::imread(path("rgb", frame.rgbd[0].color_stamp_s), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(depth.size(), cv::Size(camera.depth.width, camera.depth.height));
  ASSERT_EQ(color.size(), depth.size());
  ASSERT_EQ(depth.type(), CV_16UC1);
  const cv::Mat original_color = as_mat(frame.rgbd[0].color.own());
  int compared = 0;
  for (int y = 4; y < depth.rows; y += 9) {
    for (int x = 4; x < depth.cols; x += 9) {
      const Eigen::Vector3d ray((x - camera.depth.cx) / camera.depth.fx,
                                (y - camera.depth.cy) / camera.depth.fy, 1);
      const cv::Point2d from = project(camera.depth, {}, ray);
      const auto value = depth.at<std::uint16_t>(y, x);
      const double fraction_x = std::abs(from.x - std::round(from.x));
      const double fraction_y = std::abs(from.y - std::round(from.y));
      if (fraction_x > .45 || fraction_y > .45) continue;  // either of two pixels
      const int column = static_cast<int>(std::round(from.x));
      const int row = static_cast<int>(std::round(from.y));
      if (!camera.depth.bounds().contains(column, row)) continue;
      const double metres = frame.rgbd[0].depth.own()(column, row) * camera.depth_unit_m;
      ASSERT_NEAR(value * tum_unit_m, metres, .00011) << x << ' ' << y;
      if (value == 0) continue;
      const cv::Point2d at = project(camera.color, camera.color_from_depth, ray * metres);
      if (at.x < 1 || at.y < 1 || at.x > camera.color.width - 2 || at.y > camera.color.height - 2) {
        continue;
      }
      cv::Mat expected;
      cv::getRectSubPix(original_color, {1, 1},
                        cv::Point2f(static_cast<float>(at.x), static_cast<float>(at.y)), expected);
      for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(color.at<cv::Vec3b>(y, x)[c], expected.at<cv::Vec3b>(0, 0)[c], 12)
            << x << ' ' << y;
      }
      ++compared;
    }
  }
  EXPECT_GT(compared, 500);
  const auto lens = read_tum_camera(made);
  ASSERT_TRUE(lens);
  EXPECT_NEAR(lens->fx, camera.depth.fx, 1e-9);
  EXPECT_EQ(lens->width, camera.depth.width);
  // And it is read like any other.
  convert_tum(made, folder.path() / "again", *lens);
  EXPECT_EQ(load_recording(folder.path() / "again").rig.rgbd[0].depth.width, lens->width);
}

TEST(ConvertToTum, WhatIsWrongIsNamed) {
  const auto original = std::filesystem::path(testing::recordings_dir()) / "calendar";
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { convert_to_tum(original, folder.path() / "a", "rgbd7"); }),
              HasSubstr("expected an RGB-D camera of the recording, got 'rgbd7'"));
  for (const char* text : {"", "1 2 3\n", "0 480 5 5 1 1\n", "640 480 0 5 1 1\n",
                           "640 480 5 5 1 1\n640 480 5 5 1 1\n"}) {
    folder.write("camera.txt", text);
    EXPECT_THAT(error_of([&] { read_tum_camera(folder.path()); }), HasSubstr("camera.txt"));
  }
}

}  // namespace
}  // namespace diminish
