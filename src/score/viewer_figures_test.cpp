#include "score/viewer_figures.h"

#include <gtest/gtest.h>

#include <functional>
#include <opencv2/imgproc.hpp>

#include "diminish/diminished_frame.h"
#include "score/image_quality.h"

namespace diminish {
namespace {

constexpr int view_width = 96;
constexpr int view_height = 64;
const cv::Rect object(20, 15, 56, 34);

cv::Mat grey(const std::function<int(int x)>& level) {
  cv::Mat picture(view_height, view_width, CV_8UC3);
  for (int x = 0; x < view_width; ++x) picture.col(x).setTo(cv::Scalar::all(level(x)));
  return picture;
}
/// Dark, and bright from column `at` on.
cv::Mat step(int at) {
  return grey([at](int x) { return x < at ? 40 : 200; });
}
cv::Mat ramp(double slope) {
  return grey([slope](int x) { return static_cast<int>(20 + slope * x); });
}
cv::Mat painted(const cv::Rect& rect, int value) {
  cv::Mat image(view_height, view_width, CV_8U, cv::Scalar(0));
  image(rect).setTo(value);
  return image;
}
/// The object, all of it from one place.
ViewerFigures figures(const cv::Mat& result, const cv::Mat& truth,
                      int origin = provenance::first_rgbd) {
  return *viewer_figures(
      {result, truth, ssim_map(result, truth), painted(object, 255), painted(object, origin)});
}

TEST(ViewerFigures, OfTheTruthAreTheBest) {
  cv::Mat truth = step(48);
  cv::circle(truth, {40, 30}, 8, {90, 120, 10}, -1);
  const ViewerFigures seen = figures(truth, truth);
  EXPECT_EQ(seen.edge_recall, 1);
  EXPECT_EQ(seen.edge_precision, 1);
  EXPECT_EQ(seen.edge_f1, 1);
  EXPECT_NEAR(seen.gradient_similarity, 1, 1e-6);
  EXPECT_NEAR(*seen.sharpness_seen, 1, 1e-6);
  EXPECT_EQ(seen.invented_share, 0);
  EXPECT_FALSE(seen.sharpness_invented);
  EXPECT_FALSE(seen.invented);
  const ViewerFigures invented = figures(truth, truth, provenance::inpainted);
  EXPECT_FALSE(invented.sharpness_seen);
  EXPECT_NEAR(*invented.sharpness_invented, 1, 1e-6);
  EXPECT_EQ(invented.invented->psnr_db, 99);
  EXPECT_NEAR(invented.invented->ssim, 1, 1e-9);
  // The region is the mask grown by three pixels on each side.
  EXPECT_NEAR(invented.invented_share, 56.0 * 34 / (62 * 40), 1e-9);
}

TEST(ViewerFigures, AnEdgeMayBeTwoPixelsOff) {
  for (const int shift : {1, 2}) {
    EXPECT_EQ(figures(step(48 + shift), step(48)).edge_f1, 1) << shift;
  }
  for (const int shift : {3, 5}) {
    EXPECT_EQ(figures(step(48 + shift), step(48)).edge_f1, 0) << shift;
  }
}

// Of two edges one is lost, or one too many is there.
TEST(ViewerFigures, LostEdgesCostRecallAndWrongOnesPrecision) {
  const cv::Mat one = step(36);
  const cv::Mat two = grey([](int x) { return x < 36 || x >= 60 ? 40 : 200; });
  const ViewerFigures lost = figures(one, two);
  EXPECT_EQ(lost.edge_recall, 0.5);
  EXPECT_EQ(lost.edge_precision, 1);
  EXPECT_NEAR(lost.edge_f1, 2.0 / 3, 1e-9);
  const ViewerFigures wrong = figures(two, one);
  EXPECT_EQ(wrong.edge_recall, 1);
  EXPECT_EQ(wrong.edge_precision, 0.5);
}

// The gradient of a ramp is twice its slope, blurred or not.
TEST(ViewerFigures, OfRampsAreTheirFormulas) {
  EXPECT_NEAR(*figures(ramp(0.5), ramp(2)).sharpness_seen, 0.25, 1e-6);
  const ViewerFigures steeper = figures(ramp(2), ramp(1));
  EXPECT_NEAR(*steeper.sharpness_seen, 2, 1e-6);
  EXPECT_NEAR(steeper.gradient_similarity, (2 * 4 * 2 + 170.0) / (4 * 4 + 2 * 2 + 170), 1e-6);
}

TEST(ViewerFigures, ABlurredPatternIsLessSharp) {
  const cv::Mat truth = grey([](int x) { return x % 8 < 4 ? 60 : 180; });
  cv::Mat result;
  cv::GaussianBlur(truth, result, {}, 2);
  const ViewerFigures blurred = figures(result, truth, provenance::inpainted);
  // A Gaussian of 2 pixels leaves exp(-2 (2 pi / 8)^2) = 0.29 of a wave of 8 pixels.
  EXPECT_NEAR(*blurred.sharpness_invented, 0.29, 0.02);
  EXPECT_LT(blurred.gradient_similarity, 0.75);
}

TEST(ViewerFigures, TellWhatIsSeenFromWhatIsInvented) {
  const cv::Mat truth = ramp(2);
  cv::Mat result = truth.clone();
  const cv::Rect left(0, 0, 48, view_height);
  const cv::Rect right(48, 0, view_width - 48, view_height);
  ramp(1)(right).copyTo(result(right));
  cv::Mat origin = painted(object, provenance::first_rgbd);
  // Away from where the two meet.
  const cv::Rect filled(56, 20, 16, 20);
  origin(filled).setTo(provenance::inpainted);
  const cv::Mat ssim = ssim_map(result, truth);
  const ViewerFigures both = *viewer_figures({result, truth, ssim, painted(object, 255), origin});
  EXPECT_NEAR(*both.sharpness_invented, 0.5, 1e-6);
  EXPECT_NEAR(both.invented->psnr_db, quality(result, truth, ssim, painted(filled, 255))->psnr_db,
              1e-9);
  const ViewerFigures seen = *viewer_figures({result, truth, ssim, painted(object & left, 255),
                                              painted(object & cv::Rect(0, 0, 40, 64), 1)});
  EXPECT_NEAR(*seen.sharpness_seen, 1, 1e-6);
}

TEST(ViewerFigures, LookAtTheGrownMaskOnly) {
  const cv::Mat truth = step(48);
  cv::Mat result = truth.clone();
  // So far away that no filter reaches the region.
  result(cv::Rect(0, 0, object.x - 8, view_height)).setTo(cv::Scalar::all(255));
  const ViewerFigures same = figures(result, truth);
  EXPECT_EQ(same.edge_f1, 1);
  EXPECT_NEAR(same.gradient_similarity, 1, 1e-6);
  EXPECT_FALSE(
      viewer_figures({result, truth, ssim_map(result, truth), painted({}, 255), painted({}, 1)}));
}

TEST(ViewerFigures, FewInventedPixelsSayNothing) {
  const cv::Mat truth = ramp(2);
  const auto with = [&](const cv::Rect& filled) {
    return *viewer_figures({truth, truth, ssim_map(truth, truth), painted(object, 255),
                            painted(filled, provenance::inpainted)});
  };
  EXPECT_FALSE(with({30, 30, 10, 5}).invented);
  EXPECT_TRUE(with({30, 30, 17, 3}).invented);
}

TEST(ViewerFigures, AMeanIsOverTheFramesThatHaveTheFigure) {
  ViewerFigures a;
  a.edge_recall = 0.5;
  a.edge_precision = 1;
  a.sharpness_seen = 0.8;
  a.invented = Quality{20, 0.5};
  ViewerFigures b;
  b.edge_recall = 0.3;
  b.edge_precision = 0.2;
  const ViewerFigures mean = *mean_of({a, b});
  EXPECT_DOUBLE_EQ(mean.edge_recall, 0.4);
  EXPECT_DOUBLE_EQ(mean.edge_precision, 0.6);
  EXPECT_DOUBLE_EQ(mean.edge_f1, 2 * 0.4 * 0.6 / (0.4 + 0.6));
  EXPECT_DOUBLE_EQ(*mean.sharpness_seen, 0.8);
  EXPECT_FALSE(mean.sharpness_invented);
  EXPECT_DOUBLE_EQ(mean.invented->psnr_db, 20);
  EXPECT_FALSE(mean_of({}));
}

}  // namespace
}  // namespace diminish
