#include "diminish/score.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/mat.h"
#include "diminish/diminished_frame.h"
#include "expect_error.h"
#include "sink/indexed_png.h"
#include "sink/palette.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

constexpr int width = 80;
constexpr int height = 60;

/// Two frames whose every figure is known: the true mask is a square of 20; the run covers it
/// exactly (margin 0), has seen its left half, and is wrong there by 10 and right of it by 20
/// levels (first frame), or right everywhere (second frame).
class ScoreTest : public ::testing::Test {
 protected:
  ScoreTest() {
    for (int i = 0; i < 2; ++i) {
      const std::string name = names[i];
      save("truth/background/" + name + ".png", cv::Mat(truth));
      save("color/" + name + ".png", painted(truth, square, {255, 0, 255}));
      save("truth/mask/" + name + ".png", painted_mask(square));
      cv::Mat result = truth.clone();
      if (i == 0) {
        result(left) += cv::Scalar::all(10);
        result(right) += cv::Scalar::all(20);
      }
      save("run/result/" + name + ".png", result);
      save("run/mask/" + name + ".png", painted_mask(square));
      Image<std::uint8_t> provenance(width, height, 0);
      provenance.fill({30, 20, 10, 20}, provenance::first_rgbd);
      provenance.fill({40, 20, 10, 20}, provenance::inpainted);
      std::filesystem::create_directories(folder.path() / "run/provenance");
      write_indexed_png(folder.path() / "run/provenance" / (name + ".png"), provenance,
                        provenance_palette());
    }
    folder.write("color.txt", "# list\n1.0 color/000000.png\n1.1 color/000001.png\n");
    folder.write("run/summary.json", R"({"options": {"mask_margin_px": 0}})");
    write_csv(csv_row("000000") + csv_row("000001"));
    folder.write("truth/poses.json",
                 R"([{"frame": "000000",
                     "color_from_world": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]],
                     "rgbd0_depth_from_world": [[1, 0, 0, 0.5], [0, 1, 0, 0], [0, 0, 1, 0]]}])");
  }

  static cv::Mat painted(const cv::Mat& image, const cv::Rect& rect, const cv::Scalar& color) {
    cv::Mat copy = image.clone();
    copy(rect).setTo(color);
    return copy;
  }
  static cv::Mat painted_mask(const cv::Rect& rect) {
    return painted(cv::Mat(height, width, CV_8U, cv::Scalar(0)), rect, cv::Scalar(255));
  }
  void save(const std::string& name, const cv::Mat& image) const {
    std::filesystem::create_directories((folder.path() / name).parent_path());
    ASSERT_TRUE(cv::imwrite((folder.path() / name).string(), image));
  }
  /// The colour camera is 3 mm off and turned by 180 degrees about z; the depth sensor is exact.
  static std::string csv_row(const std::string& name) {
    return "\"" + name + "\",0,0.003,0,0,0,0,1,0,0.5,0,0,0,0,0,1,,,,,,,\n";
  }
  void write_csv(const std::string& rows) const {
    std::string header = "name,skipped";
    for (const char* pose :
         {"color_from_world", "rgbd0_depth_from_world", "color_from_rgbd0_depth"}) {
      for (const char* part : {"tx", "ty", "tz", "qx", "qy", "qz", "qw"}) {
        header += std::string(",") + pose + "_" + part;
      }
    }
    folder.write("run/frames.csv", header + "\n" + rows);
  }
  Score score() const { return score_run(folder.path(), folder.path() / "run"); }

  TemporaryFolder folder;
  const std::string names[2] = {"000000", "000001"};
  const cv::Rect square{30, 20, 20, 20}, left{30, 20, 10, 20}, right{40, 20, 10, 20};
  const cv::Mat truth{height, width, CV_8UC3, cv::Scalar(100, 120, 140)};
};

TEST_F(ScoreTest, GivesTheFiguresThatAreKnown) {
  const Score result = score();
  ASSERT_EQ(result.frames.size(), 2U);
  const FrameScore& first = result.frames[0];
  // Inside: the square grown by a disc of 3 pixels.
  cv::Mat grown;
  cv::distanceTransform(~painted_mask(square), grown, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  const double pixels = cv::countNonZero(grown <= 3.0001);
  const double mean_square = (200 * 100 + 200 * 400) / pixels;
  EXPECT_NEAR(first.inside->psnr_db, 10 * std::log10(255 * 255 / mean_square), 1e-6);
  EXPECT_NEAR(first.valid->psnr_db, 20 * std::log10(255 / 10.0), 1e-6);
  EXPECT_NEAR(first.missing->psnr_db, 20 * std::log10(255 / 20.0), 1e-6);
  EXPECT_EQ(result.frames[1].inside->psnr_db, 99);
  EXPECT_NEAR(*result.psnr_pooled_db, 10 * std::log10(255 * 255 / (mean_square / 2)), 1e-6);
  EXPECT_NEAR(result.mean.inside->psnr_db, (first.inside->psnr_db + 99) / 2, 1e-9);
  EXPECT_DOUBLE_EQ(*first.coverage, 0.5);
  EXPECT_DOUBLE_EQ(*first.mask_iou, 1);
  EXPECT_DOUBLE_EQ(*first.mask_recall, 1);
  EXPECT_EQ(first.changed_outside, 0U);
  EXPECT_NEAR(*result.flicker, (200 * 10 + 200 * 20) / pixels, 1e-9);
  EXPECT_TRUE(result.not_written.empty());
}

// Five stripes of 4 pixels, each with an error of its own.
TEST_F(ScoreTest, TellsOriginsApart) {
  constexpr std::array<int, 5> codes{2, 200, 201, 202, 254};
  Image<std::uint8_t> origins(width, height, 0);
  cv::Mat result = truth.clone();
  for (int i = 0; i < 5; ++i) {
    const Rect stripe{square.x + 4 * i, square.y, 4, square.height};
    origins.fill(stripe, static_cast<std::uint8_t>(codes[static_cast<std::size_t>(i)]));
    result(cv::Rect(stripe.x, stripe.y, stripe.width, stripe.height)) +=
        cv::Scalar::all(10 * (i + 1));
  }
  write_indexed_png(folder.path() / "run/provenance/000001.png", origins, provenance_palette());
  save("run/result/000001.png", result);
  const Score scored = score();
  cv::Mat grown;
  cv::distanceTransform(~painted_mask(square), grown, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  const double share = 4.0 * square.height / cv::countNonZero(grown <= 3.0001);
  for (int i = 0; i < 5; ++i) {
    const auto& origin = scored.frames[1].origins[static_cast<std::size_t>(i)];
    ASSERT_TRUE(origin) << score_origins[static_cast<std::size_t>(i)];
    EXPECT_NEAR(origin->share, share, 1e-9);
    EXPECT_NEAR(origin->quality.psnr_db, 20 * std::log10(255 / (10.0 * (i + 1))), 1e-6);
  }
  // The other frame has seen and invented pixels only.
  EXPECT_FALSE(scored.frames[0].origins[1]);
  EXPECT_NEAR(scored.mean.origins[1]->share, share / 2, 1e-9);
  EXPECT_THAT(score_table(scored), ::testing::HasSubstr("remembered"));
  EXPECT_THAT(score_json(scored), ::testing::HasSubstr("\"witnessed\": {"));
}

TEST_F(ScoreTest, MeasuresPosesWhereBothAreKnown) {
  const Score result = score();
  const auto& poses = result.frames[0].poses;
  ASSERT_EQ(poses.size(), 2U) << "the chained pose is unknown in this run";
  EXPECT_NEAR(poses.at("color_from_world").position_mm, 3, 1e-6);
  EXPECT_NEAR(poses.at("color_from_world").rotation_deg, 180, 1e-6);
  EXPECT_NEAR(poses.at("rgbd0_depth_from_world").position_mm, 0, 1e-6);
  EXPECT_TRUE(result.frames[1].poses.empty());
}

TEST_F(ScoreTest, CountsPixelsChangedOutsideTheMask) {
  cv::Mat result = truth.clone();
  result.at<cv::Vec3b>(3, 3) = {100, 120, 141};
  result.at<cv::Vec3b>(3, 4) = {0, 0, 0};
  save("run/result/000001.png", result);
  EXPECT_EQ(score().frames[1].changed_outside, 2U);
}

// A run that covers half of the object: half the recall, and the intersection over the union.
TEST_F(ScoreTest, MeasuresMasksWithTheRunsMargin) {
  save("run/mask/000000.png", painted_mask(left));
  EXPECT_DOUBLE_EQ(*score().frames[0].mask_recall, 0.5);
  EXPECT_DOUBLE_EQ(*score().frames[0].mask_iou, 0.5);
  folder.write("run/summary.json", R"({"options": {"mask_margin_px": 1}})");
  EXPECT_DOUBLE_EQ(*score().frames[0].mask_iou, 200.0 / (400 + 4 * 20));
}

// Removing something where there is nothing to remove has a cost.
TEST_F(ScoreTest, AFalseRemovalCosts) {
  save("truth/mask/000000.png", cv::Mat(height, width, CV_8U, cv::Scalar(0)));
  EXPECT_DOUBLE_EQ(*score().frames[0].mask_iou, 0);
  EXPECT_FALSE(score().frames[0].mask_recall);
}

TEST_F(ScoreTest, FlickerDoesNotSpanSkippedFrames) {
  write_csv(csv_row("000000") + csv_row("none") + csv_row("000001"));
  EXPECT_FALSE(score().flicker);
}

TEST_F(ScoreTest, WhatIsNotThereIsAbsentAndNotZero) {
  std::filesystem::remove_all(folder.path() / "truth/mask");
  std::filesystem::remove(folder.path() / "truth/poses.json");
  std::filesystem::remove(folder.path() / "run/result/000001.png");
  const Score result = score();
  ASSERT_EQ(result.frames.size(), 1U);
  EXPECT_TRUE(result.frames[0].inside);
  EXPECT_FALSE(result.frames[0].mask_iou);
  EXPECT_TRUE(result.frames[0].poses.empty());
  EXPECT_FALSE(result.flicker);
  EXPECT_EQ(result.not_written, std::vector<std::string>{"000001"});
  EXPECT_THAT(score_table(result), HasSubstr("000001: not written by this run"));
}

TEST_F(ScoreTest, FramesOfTheTruthThatTheRunLacksAreNamed) {
  write_csv(csv_row("000000"));
  EXPECT_EQ(score().not_written, std::vector<std::string>{"000001"});
}

TEST_F(ScoreTest, JsonAndTableSayTheSame) {
  const Score result = score();
  const auto json = nlohmann::json::parse(score_json(result));
  EXPECT_DOUBLE_EQ(json["mean"]["inside"]["psnr_db"], result.mean.inside->psnr_db);
  EXPECT_DOUBLE_EQ(json["flicker"], *result.flicker);
  EXPECT_EQ(json["frames"][0]["changed_outside"], 0);
  EXPECT_THAT(score_table(result), HasSubstr("color_from_world: 3.0 mm, 180.00 degrees off"));
}

TEST_F(ScoreTest, PicturesShowInputResultTruthAndError) {
  const Score result = score_run_with_pictures(folder.path(), folder.path() / "run");
  EXPECT_EQ(score_json(result), score_json(score()));
  const cv::Mat sheet = cv::imread((folder.path() / "run/score/000000.png").string());
  ASSERT_FALSE(sheet.empty());
  // Two rows of three panels of the picture's shape; the last is black but for the errors.
  EXPECT_NEAR(static_cast<double>(sheet.cols) / (sheet.rows - 2 * 28), 1.5 * width / height, 0.05);
  EXPECT_EQ(sheet.at<cv::Vec3b>(sheet.rows - 5, sheet.cols - 5), cv::Vec3b(0, 0, 0));
}

TEST_F(ScoreTest, WhatCannotBeScoredIsAnErrorThatNamesIt) {
  save("run/result/000001.png", cv::Mat(5, 5, CV_8UC3, cv::Scalar(0)));
  EXPECT_THAT(error_of([&] { score(); }), HasSubstr("result/000001.png"));
  folder.write("run/summary.json", "{}");
  EXPECT_THAT(error_of([&] { score(); }), HasSubstr("summary.json: options.mask_margin_px"));
  folder.write("run/summary.json", "{");
  EXPECT_THAT(error_of([&] { score(); }), HasSubstr("summary.json"));
  std::filesystem::remove(folder.path() / "run/frames.csv");
  EXPECT_THAT(error_of([&] { score(); }), HasSubstr("frames.csv"));
  std::filesystem::remove_all(folder.path() / "truth/background");
  EXPECT_THAT(error_of([&] { score(); }), HasSubstr("truth/background"));
}

}  // namespace
}  // namespace diminish
