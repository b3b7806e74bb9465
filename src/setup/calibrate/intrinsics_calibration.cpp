#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "core/robust.h"
#include "diminish/calibration.h"
#include "diminish/error.h"

namespace diminish {
namespace {

constexpr std::size_t least_views = 3;

struct Fit {
  cv::Mat camera, distortion, deviations;
  std::vector<cv::Mat> rotations, translations;
  double error_px = 0;
};

class Calibrator {
 public:
  explicit Calibrator(const ViewCollection& collection)
      : collection_(collection), size_(collection.width(), collection.height()) {
    for (const BoardView& view : collection.views()) {
      std::vector<cv::Point3f> points;
      std::vector<cv::Point2f> pixels;
      for (std::size_t i = 0; i < view.ids.size(); ++i) {
        points.emplace_back(view.points_m[i].x(), view.points_m[i].y(), 0);
        pixels.emplace_back(view.pixels[i].x(), view.pixels[i].y());
      }
      points_.push_back(std::move(points));
      pixels_.push_back(std::move(pixels));
    }
    used_.assign(points_.size(), true);
  }

  IntrinsicsCalibration calibrate() {
    Fit fit = fit_used(true);
    constexpr int most_rounds = 5;
    for (int round = 0; round < most_rounds && leave_out_bad(fit); ++round) fit = fit_used(true);
    const double k3 = fit.distortion.at<double>(4);
    if (!(std::abs(k3) > 3 * fit.deviations.at<double>(8))) fit = fit_used(false);
    return result(fit);
  }

 private:
  Fit fit_used(bool with_k3) const {
    std::vector<std::vector<cv::Point3f>> points;
    std::vector<std::vector<cv::Point2f>> pixels;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!used_[i]) continue;
      points.push_back(points_[i]);
      pixels.push_back(pixels_[i]);
    }
    Fit fit;
    try {
      fit.error_px = cv::calibrateCamera(
          points, pixels, size_, fit.camera, fit.distortion, fit.rotations, fit.translations,
          fit.deviations, cv::noArray(), cv::noArray(), with_k3 ? 0 : cv::CALIB_FIX_K3,
          {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-12});
    } catch (const cv::Exception&) {
      fit.error_px = std::numeric_limits<double>::quiet_NaN();
    }
    if (!std::isfinite(fit.error_px) || !cv::checkRange(fit.camera) ||
        !(fit.camera.at<double>(0, 0) > 0)) {
      throw Error("no camera explains the views of the board: are its squares counted right?");
    }
    return fit;
  }

  /// Every view's residuals. Views that were not used get their own pose.
  std::vector<std::vector<Eigen::Vector2d>> residuals(const Fit& fit) const {
    std::vector<std::vector<Eigen::Vector2d>> all;
    std::size_t next = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      cv::Mat rotation;
      cv::Mat translation;
      if (used_[i]) {
        rotation = fit.rotations[next];
        translation = fit.translations[next++];
      } else {
        cv::solvePnP(points_[i], pixels_[i], fit.camera, fit.distortion, rotation, translation);
      }
      std::vector<cv::Point2f> computed;
      cv::projectPoints(points_[i], rotation, translation, fit.camera, fit.distortion, computed);
      std::vector<Eigen::Vector2d> view;
      for (std::size_t c = 0; c < computed.size(); ++c) {
        const cv::Point2f difference = pixels_[i][c] - computed[c];
        view.emplace_back(difference.x, difference.y);
      }
      all.push_back(std::move(view));
    }
    return all;
  }

  static double root_mean_square(const std::vector<Eigen::Vector2d>& residuals) {
    double squares = 0;
    for (const auto& residual : residuals) squares += residual.squaredNorm();
    return std::sqrt(squares / static_cast<double>(residuals.size()));
  }

  /// Decides again which views to use. Returns whether anything changed.
  bool leave_out_bad(const Fit& fit) {
    std::vector<double> errors;
    for (const auto& view : residuals(fit)) errors.push_back(root_mean_square(view));
    std::vector<double> sorted = errors;
    const double usual = median(sorted);
    // Detection alone has errors of some hundredths of a pixel.
    const double most = std::max(2.5 * usual, 0.15);
    std::vector<bool> used(errors.size());
    std::transform(errors.begin(), errors.end(), used.begin(),
                   [most](double error) { return error <= most; });
    if (used == used_ || std::count(used.begin(), used.end(), true) < std::ptrdiff_t{least_views}) {
      return false;
    }
    used_ = used;
    return true;
  }

  IntrinsicsCalibration result(const Fit& fit) const {
    IntrinsicsCalibration result;
    Intrinsics& camera = result.intrinsics;
    camera.width = size_.width;
    camera.height = size_.height;
    camera.fx = fit.camera.at<double>(0, 0);
    camera.fy = fit.camera.at<double>(1, 1);
    camera.cx = fit.camera.at<double>(0, 2);
    camera.cy = fit.camera.at<double>(1, 2);
    for (int i = 0; i < 5; ++i) {
      camera.distortion[static_cast<std::size_t>(i)] = fit.distortion.at<double>(i);
    }
    for (int i = 0; i < 9; ++i) {
      result.deviations[static_cast<std::size_t>(i)] = fit.deviations.at<double>(i);
    }
    result.error_px = fit.error_px;
    result.residuals_px = residuals(fit);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      result.views.push_back(
          {collection_.views()[i].name, root_mean_square(result.residuals_px[i]), used_[i]});
    }
    add_warnings(result);
    return result;
  }

  void add_warnings(IntrinsicsCalibration& result) const {
    const auto used = std::count(used_.begin(), used_.end(), true);
    const auto warn = [&](const std::string& text) { result.warnings.push_back(text); };
    if (used < 8) warn(fmt::format("only {} views of the board: take 15 or more", used));
    if (collection_.coverage() < 0.6) {
      warn(fmt::format("corners cover {:.0f} % of the picture: show the board at its edges, too",
                       100 * collection_.coverage()));
    }
    if (collection_.tilts() < 3) {
      warn("the board hardly leans: tilt it by 20 to 45 degrees in different directions");
    }
    const double focal_deviation = result.deviations[0] / result.intrinsics.fx;
    if (focal_deviation > 0.005) {
      warn(fmt::format("the focal length is uncertain by {:.1f} %", 100 * focal_deviation));
    }
    if (result.error_px > 1) {
      warn(
          fmt::format("the reprojection error is {:.2f} pixels: is the board flat, the picture "
                      "sharp, and the board's description right?",
                      result.error_px));
    }
  }

  const ViewCollection& collection_;
  cv::Size size_;
  std::vector<std::vector<cv::Point3f>> points_;
  std::vector<std::vector<cv::Point2f>> pixels_;
  std::vector<bool> used_;
};

}  // namespace

IntrinsicsCalibration calibrate_intrinsics(const ViewCollection& views) {
  if (views.views().size() < least_views) {
    throw Error(fmt::format(
        "expected at least {} different views of the board, got {}: is --board what was printed?",
        least_views, views.views().size()));
  }
  return Calibrator(views).calibrate();
}

}  // namespace diminish
