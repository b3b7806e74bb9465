#include "setup/calibrate/lens_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/calib3d.hpp>

#include "diminish/error.h"

namespace diminish {
namespace {

using Points = LensFit::Points;
using Pixels = LensFit::Pixels;

const cv::TermCriteria until_nothing_changes(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100,
                                             1e-12);

bool is_camera(const LensFit& fit) {
  return std::isfinite(fit.error_px) && cv::checkRange(fit.camera) &&
         cv::checkRange(fit.distortion) && fit.camera.at<double>(0, 0) > 0;
}

void fit_polynomial(bool with_k3, const std::vector<Points>& points,
                    const std::vector<Pixels>& pixels, const cv::Size& size, LensFit& fit) {
  int flags = with_k3 ? 0 : cv::CALIB_FIX_K3;
  if (fit.model == LensModel::rational) flags = cv::CALIB_RATIONAL_MODEL;
  cv::Mat deviations;
  fit.error_px = cv::calibrateCamera(points, pixels, size, fit.camera, fit.distortion,
                                     fit.rotations, fit.translations, deviations, cv::noArray(),
                                     cv::noArray(), flags, until_nothing_changes);
  for (std::size_t i = 0; i < 4 + coefficient_count(fit.model); ++i) {
    fit.deviations.push_back(deviations.at<double>(static_cast<int>(i)));
  }
}

/// From one focal length on: with a wrong one the fit ends somewhere else.
void fit_fisheye_from(double focal_length, const std::vector<Points>& points,
                      const std::vector<Pixels>& pixels, const cv::Size& size, LensFit& fit) {
  fit.camera = (cv::Mat_<double>(3, 3) << focal_length, 0, (size.width - 1) / 2.0,  //
                0, focal_length, (size.height - 1) / 2.0, 0, 0, 1);
  fit.distortion = cv::Mat::zeros(4, 1, CV_64F);
  std::vector<cv::Vec3d> rotations;
  std::vector<cv::Vec3d> translations;
  fit.error_px = cv::fisheye::calibrate(
      points, pixels, size, fit.camera, fit.distortion, rotations, translations,
      cv::fisheye::CALIB_USE_INTRINSIC_GUESS | cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC |
          cv::fisheye::CALIB_FIX_SKEW,
      until_nothing_changes);
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    fit.rotations.emplace_back(rotations[i], true);
    fit.translations.emplace_back(translations[i], true);
  }
}

/// OpenCV has none for fisheyes: from the derivatives of all corners, the views' poses eliminated.
void find_fisheye_deviations(const std::vector<Points>& points, LensFit& fit) {
  using Matrix8 = Eigen::Matrix<double, 8, 8>;
  using Derivatives = Eigen::Matrix<double, Eigen::Dynamic, 15, Eigen::RowMajor>;
  Matrix8 information = Matrix8::Zero();
  double unknowns = 8;
  double numbers = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Pixels projected;
    cv::Mat by_parameters;  // fx, fy, cx, cy, k1 to k4, rotation, translation, skew
    cv::fisheye::projectPoints(points[i], projected, fit.rotations[i], fit.translations[i],
                               fit.camera, fit.distortion, 0, by_parameters);
    const Eigen::Map<const Derivatives> all(by_parameters.ptr<double>(), by_parameters.rows, 15);
    const auto lens = all.leftCols<8>();
    const auto pose = all.middleCols<6>(8);
    const Eigen::Matrix<double, 8, 6> mixed = lens.transpose() * pose;
    const Eigen::Matrix<double, 6, 6> of_pose = pose.transpose() * pose;
    information += lens.transpose() * lens - mixed * of_pose.ldlt().solve(mixed.transpose());
    unknowns += 6;
    numbers += static_cast<double>(by_parameters.rows);
  }
  // error_px is of corners, which are two numbers each.
  const double squares = fit.error_px * fit.error_px * numbers / 2;
  const Matrix8 covariance = squares / std::max(1.0, numbers - unknowns) * information.inverse();
  for (int i = 0; i < 8; ++i) fit.deviations.push_back(std::sqrt(std::max(0.0, covariance(i, i))));
}

void fit_fisheye(const std::vector<Points>& points, const std::vector<Pixels>& pixels,
                 const cv::Size& size, LensFit& fit) {
  fit.error_px = std::numeric_limits<double>::quiet_NaN();
  for (const double view_degrees : {180.0, 120.0, 80.0}) {
    LensFit tried{fit.model, {}, {}, {}, {}, {}, 0};
    const double focal_length =
        std::max(size.width, size.height) / (view_degrees * std::numbers::pi / 180);
    try {
      fit_fisheye_from(focal_length, points, pixels, size, tried);
    } catch (const cv::Exception&) {
      continue;
    }
    if (is_camera(tried) && !(tried.error_px >= fit.error_px)) fit = tried;
  }
  if (is_camera(fit)) find_fisheye_deviations(points, fit);
}

}  // namespace

LensFit LensFit::of(LensModel model, bool with_k3, const std::vector<Points>& points,
                    const std::vector<Pixels>& pixels, const cv::Size& size) {
  LensFit fit{model, {}, {}, {}, {}, {}, 0};
  try {
    if (model == LensModel::fisheye) {
      fit_fisheye(points, pixels, size, fit);
    } else {
      fit_polynomial(with_k3, points, pixels, size, fit);
    }
  } catch (const cv::Exception&) {
    fit.error_px = std::numeric_limits<double>::quiet_NaN();
  }
  if (!is_camera(fit)) {
    throw Error("no camera explains the views of the board: are its squares counted right?");
  }
  return fit;
}

Intrinsics LensFit::intrinsics(const cv::Size& size) const {
  Intrinsics result;
  result.width = size.width;
  result.height = size.height;
  result.fx = camera.at<double>(0, 0);
  result.fy = camera.at<double>(1, 1);
  result.cx = camera.at<double>(0, 2);
  result.cy = camera.at<double>(1, 2);
  result.lens_model = model;
  for (std::size_t i = 0; i < coefficient_count(model); ++i) {
    result.distortion[i] = distortion.at<double>(static_cast<int>(i));
  }
  return result;
}

Pixels LensFit::project(const Points& points, const cv::Mat& rotation,
                        const cv::Mat& translation) const {
  Pixels pixels;
  if (model == LensModel::fisheye) {
    cv::fisheye::projectPoints(points, pixels, rotation, translation, camera, distortion);
  } else {
    cv::projectPoints(points, rotation, translation, camera, distortion, pixels);
  }
  return pixels;
}

void LensFit::find_pose(const Points& points, const Pixels& pixels, cv::Mat& rotation,
                        cv::Mat& translation) const {
  if (model == LensModel::fisheye) {
    Pixels ideal;
    cv::fisheye::undistortPoints(pixels, ideal, camera, distortion);
    cv::solvePnP(points, ideal, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rotation, translation);
  } else {
    cv::solvePnP(points, pixels, camera, distortion, rotation, translation);
  }
}

}  // namespace diminish
