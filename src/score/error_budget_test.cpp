#include "score/error_budget.h"

#include <gtest/gtest.h>

#include <numeric>
#include <opencv2/imgproc.hpp>

namespace diminish {
namespace {

/// Smooth random blobs: shifts show, but there are no edges.
cv::Mat blobs() {
  cv::Mat picture(120, 160, CV_8UC3);
  cv::RNG random(3);
  random.fill(picture, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(picture, picture, {}, 8);
  cv::normalize(picture, picture, 80, 160, cv::NORM_MINMAX);
  return picture;
}

cv::Mat filled(const cv::Rect& rect) {
  cv::Mat mask = cv::Mat::zeros(120, 160, CV_8U);
  mask(rect).setTo(255);
  return mask;
}

double share(const ErrorCauses& causes, const std::string& name) {
  for (std::size_t i = 0; i < error_causes.size(); ++i) {
    if (name == error_causes[i]) return causes.budget.value()[i];
  }
  throw std::out_of_range(name);
}

class ErrorBudgetTest : public ::testing::Test {
 protected:
  const cv::Mat truth = blobs();
  const cv::Rect object{30, 20, 100, 80};
  const cv::Mat whole = filled(object);
  ErrorInput input{truth.clone(), truth, whole, whole, whole};
};

TEST_F(ErrorBudgetTest, WithoutErrorThereIsNoBudget) {
  EXPECT_FALSE(find_error_causes(input).budget);
}

TEST_F(ErrorBudgetTest, AShiftIsThePoses) {
  cv::warpAffine(truth, input.result, cv::Matx23d(1, 0, 3, 0, 1, -2), truth.size(), 0,
                 cv::BORDER_REPLICATE);
  EXPECT_GT(share(find_error_causes(input), "pose"), 0.95);
}

TEST_F(ErrorBudgetTest, ACommonOffsetIsColor) {
  input.result = truth + cv::Scalar(9, -7, 5);
  const ErrorCauses causes = find_error_causes(input);
  // What was seen ends somewhere, and that counts as an edge.
  EXPECT_GT(share(causes, "color"), 0.75);
  EXPECT_LT(share(causes, "texture"), 0.02);
}

TEST_F(ErrorBudgetTest, NoiseIsTexture) {
  cv::Mat noise(truth.size(), CV_16SC3);
  cv::RNG(5).fill(noise, cv::RNG::NORMAL, 0, 6);
  cv::add(truth, noise, input.result, cv::noArray(), CV_8U);
  EXPECT_GT(share(find_error_causes(input), "texture"), 0.7);
}

TEST_F(ErrorBudgetTest, WhatNobodySawIsMissingAndWhatWasNotCoveredIsTheMasks) {
  input.seen = filled({30, 20, 50, 80});
  input.mask = filled({30, 20, 75, 80});
  cv::Mat(truth + cv::Scalar::all(20)).copyTo(input.result, filled({80, 20, 50, 80}));
  const ErrorCauses causes = find_error_causes(input);
  EXPECT_NEAR(share(causes, "missing"), 0.5, 1e-9);
  EXPECT_NEAR(share(causes, "mask"), 0.5, 1e-9);
}

TEST_F(ErrorBudgetTest, AnEdgeInTheWrongPlaceIsTheEdges) {
  cv::Mat sharp(120, 160, CV_8UC3, cv::Scalar(60, 60, 60));
  sharp(cv::Rect(60, 40, 40, 40)).setTo(cv::Scalar(200, 180, 160));
  cv::Mat larger(120, 160, CV_8UC3, cv::Scalar(60, 60, 60));
  larger(cv::Rect(57, 37, 46, 46)).setTo(cv::Scalar(200, 180, 160));
  input.truth = sharp;
  input.result = larger;
  EXPECT_GT(share(find_error_causes(input), "edges"), 0.95);
}

TEST_F(ErrorBudgetTest, SharesSumToOneAndSquaresToTheError) {
  cv::warpAffine(truth, input.result, cv::Matx23d(1, 0, 1, 0, 1, 1), truth.size());
  input.result += cv::Scalar(4, 0, 3);
  input.seen = filled({30, 20, 60, 80});
  const ErrorCauses causes = find_error_causes(input);
  EXPECT_NEAR(std::accumulate(causes.budget->begin(), causes.budget->end(), 0.0), 1, 1e-9);
  double sum = 0;
  for (const cv::Mat& squares : causes.squares) sum += cv::sum(squares).val[0];
  EXPECT_NEAR(sum, std::pow(cv::norm(input.result, truth, cv::NORM_L2, whole), 2), 1e-6 * sum);
}

}  // namespace
}  // namespace diminish
