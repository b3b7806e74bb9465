#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/robust.h"
#include "diminish/calibration.h"
#include "diminish/error.h"
#include "setup/calibrate/lens_fit.h"

namespace diminish {
namespace {

constexpr std::size_t least_views = 3;

class Calibrator {
 public:
  Calibrator(const ViewCollection& collection, LensModel model)
      : collection_(collection), model_(model), size_(collection.width(), collection.height()) {
    for (const BoardView& view : collection.views()) {
      LensFit::Points points;
      LensFit::Pixels pixels;
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
    LensFit fit = fit_used(true);
    constexpr int most_rounds = 5;
    for (int round = 0; round < most_rounds && leave_out_bad(fit); ++round) fit = fit_used(true);
    if (model_ == LensModel::plumb_bob) {
      const double k3 = fit.distortion.at<double>(4);
      if (!(std::abs(k3) > 3 * fit.deviations[8])) fit = fit_used(false);
    }
    return result(fit);
  }

 private:
  LensFit fit_used(bool with_k3) const {
    std::vector<LensFit::Points> points;
    std::vector<LensFit::Pixels> pixels;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!used_[i]) continue;
      points.push_back(points_[i]);
      pixels.push_back(pixels_[i]);
    }
    return LensFit::of(model_, with_k3, points, pixels, size_);
  }

  /// Every view's residuals. Views that were not used get their own pose.
  std::vector<std::vector<Eigen::Vector2d>> residuals(const LensFit& fit) const {
    std::vector<std::vector<Eigen::Vector2d>> all;
    std::size_t next = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      cv::Mat rotation;
      cv::Mat translation;
      if (used_[i]) {
        rotation = fit.rotations[next];
        translation = fit.translations[next++];
      } else {
        fit.find_pose(points_[i], pixels_[i], rotation, translation);
      }
      const LensFit::Pixels computed = fit.project(points_[i], rotation, translation);
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
  bool leave_out_bad(const LensFit& fit) {
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

  IntrinsicsCalibration result(const LensFit& fit) const {
    IntrinsicsCalibration result;
    result.intrinsics = fit.intrinsics(size_);
    std::copy(fit.deviations.begin(), fit.deviations.end(), result.deviations.begin());
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
    if (!Lens(result.intrinsics).covers_picture()) {
      warn(
          model_ == LensModel::fisheye
              ? "corners of the picture are 85 degrees and more off the axis: the camera cannot be "
                "used"
              : "at the picture's corners the lens is not known: show the board there, too");
    }
    if (result.error_px > 1) {
      warn(
          fmt::format("the reprojection error is {:.2f} pixels: is the board flat, the picture "
                      "sharp, and the board's description right?",
                      result.error_px));
    }
  }

  const ViewCollection& collection_;
  LensModel model_;
  cv::Size size_;
  std::vector<LensFit::Points> points_;
  std::vector<LensFit::Pixels> pixels_;
  std::vector<bool> used_;
};

}  // namespace

IntrinsicsCalibration calibrate_intrinsics(const ViewCollection& views, LensModel model) {
  if (views.views().size() < least_views) {
    throw Error(Error::input, fmt::format("expected at least {} different views of the board, got "
                                          "{}: is --board what was printed?",
                                          least_views, views.views().size()));
  }
  return Calibrator(views, model).calibrate();
}

}  // namespace diminish
