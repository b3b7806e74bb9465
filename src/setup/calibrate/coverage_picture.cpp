#include "setup/calibrate/coverage_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/mat.h"

namespace diminish {

Image<Bgr> coverage_picture(const ViewCollection& views, const IntrinsicsCalibration& result,
                            double magnification) {
  constexpr int width = 800;
  const double scale = static_cast<double>(width) / views.width();
  const int height = static_cast<int>(std::lround(scale * views.height()));
  Image<Bgr> picture(width, height, {255, 255, 255});
  cv::Mat mat = as_mat(picture);
  const Image<int>& cells = views.cells();
  for (int y = 0; y < cells.height(); ++y) {
    for (int x = 0; x < cells.width(); ++x) {
      const cv::Point from(x * width / cells.width(), y * height / cells.height());
      const cv::Point to((x + 1) * width / cells.width(), (y + 1) * height / cells.height());
      // Paler green for more views, up to eight.
      const int n = std::min(cells(x, y), 8);
      const cv::Scalar color =
          n == 0 ? cv::Scalar(150, 150, 160) : cv::Scalar(250 - 12 * n, 250 - 2 * n, 250 - 14 * n);
      cv::rectangle(mat, from, to, color, cv::FILLED);
      cv::rectangle(mat, from, to, cv::Scalar(255, 255, 255), 1);
    }
  }
  constexpr int fraction_bits = 4;
  const auto place = [&](const Eigen::Vector2d& pixel) {
    const double unit = 1 << fraction_bits;
    return cv::Point(static_cast<int>(std::lround(((pixel.x() + 0.5) * scale - 0.5) * unit)),
                     static_cast<int>(std::lround(((pixel.y() + 0.5) * scale - 0.5) * unit)));
  };
  for (std::size_t i = 0; i < views.views().size(); ++i) {
    const bool used = result.views[i].used;
    const cv::Scalar color = used ? cv::Scalar(160, 70, 0) : cv::Scalar(120, 120, 120);
    for (std::size_t c = 0; c < views.views()[i].pixels.size(); ++c) {
      const Eigen::Vector2d& pixel = views.views()[i].pixels[c];
      cv::circle(mat, place(pixel), 2 << fraction_bits, color, cv::FILLED, cv::LINE_AA,
                 fraction_bits);
      const Eigen::Vector2d end = pixel + magnification * result.residuals_px[i][c];
      cv::line(mat, place(pixel), place(end), used ? cv::Scalar(0, 0, 220) : color, 1, cv::LINE_AA,
               fraction_bits);
    }
  }
  return picture;
}

}  // namespace diminish
