#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "detection.h"
#include "expect_error.h"
#include "mask_overlap.h"
#include "paths.h"
#include "temporary_folder.h"
#include "truth_poses.h"

namespace diminish {
namespace {

using testing::recordings;

class ColorBlobOnBall : public ::testing::Test {
 protected:
  const Recording recording = load_recording(recordings / "ball");
  const OccluderSpec& spec = recording.scene.occluders.at(0);
  const std::unique_ptr<OccluderDetector> detector =
      Registry<OccluderDetector>::get("color_blob").make(spec, recording.rig);
  Detection detection{recording.rig};
};

TEST_F(ColorBlobOnBall, FindsTheTruth) {
  const TruthPoses truth(recording.folder);
  EXPECT_FALSE(detector->needs_markers());
  ASSERT_GT(truth.size(), 0u);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const std::string& name = truth.frame(i);
    SCOPED_TRACE(name);
    detection.frame.color = read_color_image(recording.folder / "color" / (name + ".jpg"));
    detection.frame.rgbd[0].color =
        read_color_image(recording.folder / "rgbd0" / "color" / (name + ".jpg"));
    const OccluderReport report = detection.detect(*detector);
    EXPECT_TRUE(report.in_color);
    EXPECT_TRUE(report.in_rgbd[0]);
    EXPECT_EQ(report.message, "");
    const Mask expected = read_mask_image(recording.folder / "truth" / "mask" / (name + ".png"));
    EXPECT_GT(intersection_over_union(detection.masks.color, expected), 0.98);
    EXPECT_FALSE(any_set(detection.masks.rgbd_depth[0]));

    // The same again, bit for bit.
    const OcclusionMasks first = detection.masks;
    detection.detect(*detector);
    EXPECT_EQ(detection.masks.color, first.color);
    EXPECT_EQ(detection.masks.rgbd_color, first.rgbd_color);
  }
}

/// The training images of the RGB-D camera show the ball cut off by the picture's border.
TEST_F(ColorBlobOnBall, FindsABallThatIsCutOff) {
  const std::filesystem::path folder = recording.folder / "training" / "rgbd0";
  for (const char* name : {"000016", "000022", "000028"}) {
    SCOPED_TRACE(name);
    detection.frame.rgbd[0].color = read_color_image(folder / (std::string(name) + ".jpg"));
    EXPECT_TRUE(detection.detect(*detector).in_rgbd[0]);
    const Mask expected = read_mask_image(folder / (std::string(name) + "_mask.png"));
    EXPECT_GT(intersection_over_union(detection.masks.rgbd_color[0], expected), 0.97);
  }
}

TEST_F(ColorBlobOnBall, FindsNothingWhereThereIsNoBall) {
  for (const char* name : {"000000", "000002"}) {
    const std::filesystem::path background = recording.folder / "truth" / "background";
    detection.frame.color = read_color_image(background / (std::string(name) + ".jpg"));
    const OccluderReport report = detection.detect(*detector);
    EXPECT_FALSE(report.in_color);
    EXPECT_EQ(report.message, "ball: no blob of its colour and shape in any camera");
    EXPECT_FALSE(any_set(detection.masks.color));
  }
}

TEST_F(ColorBlobOnBall, ACameraWithoutImagesIsLeftAlone) {
  const std::filesystem::path images = recording.folder / "rgbd0" / "color";
  detection.frame.rgbd[0].color = read_color_image(images / "000000.jpg");
  detection.frame.rgbd[0].missing = "late";
  EXPECT_FALSE(detection.detect(*detector).in_rgbd[0]);
  EXPECT_FALSE(any_set(detection.masks.rgbd_color[0]));
}

/// A rig with one colour camera, and an object whose colour is learnt from a drawing.
class ColorBlobOnDrawings : public ::testing::Test {
 protected:
  static constexpr int width = 640;
  static constexpr int height = 480;

  ColorBlobOnDrawings() {
    const std::filesystem::path images = folder.path() / "training" / "color";
    std::filesystem::create_directories(images);
    cv::Mat image(height, width, CV_8UC3, cv::Scalar(90, 110, 100));
    cv::Mat mask = cv::Mat::zeros(image.size(), CV_8U);
    cv::circle(image, {300, 200}, 60, orange, cv::FILLED);
    cv::circle(mask, {300, 200}, 60, 255, cv::FILLED);
    cv::imwrite((images / "0.png").string(), image);
    cv::imwrite((images / "0_mask.png").string(), mask);
    rig.color = {width, height, 500, 500, 320, 240, {}};
  }

  std::unique_ptr<OccluderDetector> make(const std::string& shape) {
    return make_detector(
        "{name: toy, detector: color_blob, training: training, shape: " + shape + "}", rig,
        folder.path() / "scene.yaml");
  }

  Mask find(const std::string& shape, const cv::Mat& picture) {
    Detection detection(rig);
    copy_from(picture, detection.frame.color.own());
    detection.detect(*make(shape));
    return detection.masks.color;
  }

  static cv::Mat empty_picture() { return {height, width, CV_8UC3, cv::Scalar(90, 110, 100)}; }

  const cv::Scalar orange{20, 120, 230};
  TemporaryFolder folder;
  Rig rig;
};

TEST_F(ColorBlobOnDrawings, AnyShapeIsFoundWithItsLargeHole) {
  cv::Mat picture = empty_picture();
  Mask expected(width, height);
  cv::Mat drawn = as_mat(expected);
  cv::rectangle(drawn, {100, 100}, {299, 219}, 255, cv::FILLED);
  cv::rectangle(drawn, {140, 130}, {259, 189}, 0, cv::FILLED);
  cv::rectangle(drawn, {400, 300}, {439, 459}, 255, cv::FILLED);
  picture.setTo(orange, drawn);
  cv::circle(picture, {120, 160}, 4, {255, 255, 255}, cv::FILLED);  // a highlight
  EXPECT_GT(intersection_over_union(find("any", picture), expected), 0.95);
}

TEST_F(ColorBlobOnDrawings, OfManyBlobsACircleIsChosen) {
  cv::Mat picture = empty_picture();
  cv::rectangle(picture, {20, 20}, {219, 119}, orange, cv::FILLED);
  cv::circle(picture, {600, 40}, 9, orange, cv::FILLED);
  Mask expected(width, height);
  cv::Mat drawn = as_mat(expected);
  cv::circle(drawn, {400, 300}, 50, 255, cv::FILLED);
  picture.setTo(orange, drawn);
  EXPECT_GT(intersection_over_union(find("circle", picture), expected), 0.97);
}

TEST_F(ColorBlobOnDrawings, AnotherColourIsNotTheObject) {
  cv::Mat picture = empty_picture();
  cv::circle(picture, {400, 300}, 50, {20, 230, 120}, cv::FILLED);
  cv::circle(picture, {200, 300}, 50, {60, 60, 230}, cv::FILLED);
  EXPECT_FALSE(any_set(find("circle", picture)));
  EXPECT_FALSE(any_set(find("any", picture)));
}

TEST_F(ColorBlobOnDrawings, SizesThatTheScaleDoesNotDivideAreCoveredToTheBorder) {
  rig.color.width = 1283;
  rig.color.height = 721;
  cv::Mat picture(rig.color.height, rig.color.width, CV_8UC3, cv::Scalar(90, 110, 100));
  cv::circle(picture, {1282, 720}, 200, orange, cv::FILLED);
  const Mask mask = find("circle", picture);
  EXPECT_EQ(mask(1282, 720), 255);
  EXPECT_EQ(mask(1282, 540), 255);
  EXPECT_EQ(mask(1100, 720), 255);
  EXPECT_EQ(mask(1000, 500), 0);
}

TEST_F(ColorBlobOnDrawings, WrongSettingsAreNamed) {
  EXPECT_THAT(error_of([&] { make("square"); }), ::testing::HasSubstr("shape"));
  EXPECT_THAT(error_of([&] {
                make_detector("{name: toy, detector: color_blob, training: nowhere}", rig,
                              folder.path() / "scene.yaml");
              }),
              ::testing::HasSubstr("nowhere"));
}

}  // namespace
}  // namespace diminish
