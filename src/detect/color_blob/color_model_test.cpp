#include "detect/color_blob/color_model.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "expect_error.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A training image: a disc of `color` (blue, green, red) on grey.
void write_training_image(const fs::path& folder, const std::string& name, const cv::Scalar& color,
                          int radius = 20) {
  fs::create_directories(folder);
  cv::Mat image(100, 120, CV_8UC3, cv::Scalar(120, 120, 120));
  cv::Mat mask = cv::Mat::zeros(image.size(), CV_8U);
  cv::circle(image, {60, 50}, radius, color, cv::FILLED);
  cv::circle(mask, {60, 50}, radius, 255, cv::FILLED);
  cv::imwrite((folder / (name + ".png")).string(), image);
  cv::imwrite((folder / (name + "_mask.png")).string(), mask);
}

TEST(ColorModel, LearnsMeansAndSpreads) {
  const TemporaryFolder folder;
  // Two reds, on both sides of hue 0.
  write_training_image(folder.path(), "0", {0, 40, 200});
  write_training_image(folder.path(), "1", {40, 0, 200});
  const ColorModel model = train_color_model(folder.path());
  EXPECT_NEAR(model.hue_deg, 0, 0.1);
  EXPECT_NEAR(model.hue_spread_deg, 12, 0.1);  // both are 12 degrees from the mean
  EXPECT_NEAR(model.saturation, 1, 1e-6);
  EXPECT_NEAR(model.saturation_spread, 0, 1e-6);
  EXPECT_NEAR(model.value, 200 / 255.0, 1e-6);
  EXPECT_NEAR(model.smallest_area, CV_PI * 20 * 20 / (100 * 120), 0.003);
}

TEST(ColorModel, DeviationCountsStandardDeviations) {
  ColorModel model;
  model.hue_deg = 170;
  model.hue_spread_deg = 10;
  model.saturation = 0.8;
  model.saturation_spread = 0.1;
  model.value = 0.5;
  model.value_spread = 0.25;
  // Hue 180 (+ 10), saturation 0.6 (- 2 * 0.1), value 0.75 (+ 0.25).
  const ColorDeviation deviation = model.deviation(255 * Eigen::Vector3d(0.75, 0.75, 0.3));
  EXPECT_NEAR(deviation.tint, 2, 1e-6);
  EXPECT_NEAR(deviation.value, 1, 1e-6);
  // Hue 190 is 20 from 170, saturation 0.8: across the jump at 180.
  const double hue_190 = 0.1 + 0.4 * (1 - 10 / 60.0);
  EXPECT_NEAR(model.deviation(255 * Eigen::Vector3d(0.5, hue_190, 0.1)).tint, 2, 1e-6);
}

TEST(ColorModel, AGreyObjectHasNoHue) {
  const TemporaryFolder folder;
  write_training_image(folder.path(), "0", {100, 100, 101});
  const ColorModel model = train_color_model(folder.path());
  EXPECT_LT(model.deviation({101, 100, 100}).tint, 1);
  EXPECT_LT(model.deviation({100, 103, 100}).tint, 1);
  EXPECT_GT(model.deviation({100, 180, 100}).tint, 3);
  EXPECT_GT(model.deviation({180, 180, 180}).value, 2);
}

TEST(ColorModel, IsKeptBesideTheImagesUntilTheyChange) {
  const TemporaryFolder folder;
  write_training_image(folder.path(), "0", {200, 40, 0});
  const ColorModel trained = load_color_model(folder.path());
  const fs::path file = color_model_file(folder.path());
  ASSERT_TRUE(fs::exists(file));

  ColorModel changed = trained;
  changed.value_spread = 0.123456789012345678;
  ASSERT_TRUE(save_color_model(changed, file));
  EXPECT_EQ(load_color_model(folder.path()).value_spread, changed.value_spread);

  write_training_image(folder.path(), "1", {200, 40, 0});
  fs::last_write_time(folder.path() / "1.png", fs::last_write_time(file) + std::chrono::seconds(1));
  EXPECT_NEAR(load_color_model(folder.path()).value_spread, trained.value_spread, 1e-6);
}

TEST(ColorModel, WithoutAWritableFolderItIsTrainedEachTime) {
  const TemporaryFolder folder;
  write_training_image(folder.path(), "0", {200, 40, 0});
  // A folder with the model's name, older than the images: nothing can be written in its place.
  const fs::path file = color_model_file(folder.path());
  fs::create_directories(file / "in the way");
  fs::last_write_time(file, fs::last_write_time(folder.path() / "0.png") - std::chrono::hours(1));
  EXPECT_NEAR(load_color_model(folder.path()).value, 200 / 255.0, 1e-6);
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 3u);  // nothing left over
}

TEST(ColorModel, WhatIsWrongWithTheImagesIsNamed) {
  const TemporaryFolder folder;
  const fs::path images = folder.path() / "color";
  EXPECT_THAT(error_of([&] { train_color_model(images); }),
              HasSubstr(images.string() + ": expected training images"));
  write_training_image(images, "0", {200, 40, 0});
  const fs::path mask = images / "0_mask.png";

  fs::remove(mask);
  EXPECT_THAT(error_of([&] { train_color_model(images); }),
              HasSubstr(mask.string() + ": expected the mask of 0.png"));
  cv::imwrite(mask.string(), cv::Mat(10, 20, CV_8U, cv::Scalar(255)));
  EXPECT_THAT(error_of([&] { train_color_model(images); }),
              HasSubstr(mask.string() + ": expected 0.png's size 120 x 100, got 20 x 10"));
  cv::imwrite(mask.string(), cv::Mat(100, 120, CV_8U, cv::Scalar(0)));
  EXPECT_THAT(error_of([&] { train_color_model(images); }),
              HasSubstr(mask.string() + ": expected pixels of 255"));
  std::ofstream(mask) << "not an image";
  EXPECT_THAT(error_of([&] { train_color_model(images); }),
              HasSubstr(mask.string() + ": expected an image"));
}

TEST(ColorModel, ACameraWithoutItsOwnFolderUsesTheColourCameras) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "rgbd0");
  EXPECT_EQ(training_folder(folder.path(), "rgbd0"), folder.path() / "rgbd0");
  EXPECT_EQ(training_folder(folder.path(), "rgbd1"), folder.path() / "color");
}

}  // namespace
}  // namespace diminish
