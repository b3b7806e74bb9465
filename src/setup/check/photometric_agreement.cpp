#include "setup/check/photometric_agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/mat.h"
#include "core/robust.h"
#include "geometry/shrunk_camera.h"

namespace diminish {
namespace {

constexpr int wanted_width = 320;
constexpr int block = 16;
constexpr double least_seen = 0.6;
/// Standard deviation in levels; below it a block is noise.
constexpr double least_texture = 4;
constexpr std::size_t least_blocks = 8;

/// The camera of the picture, shrunk by an integer factor.
Intrinsics shrunk(const Intrinsics& camera) {
  return shrunk_camera(camera, std::max(1, camera.width / wanted_width));
}

cv::Mat grey_of(ImageView<Bgr> image) {
  cv::Mat grey;
  cv::cvtColor(as_mat(image), grey, cv::COLOR_BGR2GRAY);
  grey.convertTo(grey, CV_32F);
  return grey;
}

/// The correlation of the known (not negative) pixels in `seen`.
std::optional<double> correlate(const cv::Mat& a, const cv::Mat& seen) {
  double n = 0;
  double sum_a = 0;
  double sum_b = 0;
  double aa = 0;
  double bb = 0;
  double ab = 0;
  for (int y = 0; y < a.rows; ++y) {
    for (int x = 0; x < a.cols; ++x) {
      const double b = seen.at<float>(y, x);
      if (b < 0) continue;
      const double v = a.at<float>(y, x);
      ++n;
      sum_a += v;
      sum_b += b;
      aa += v * v;
      bb += b * b;
      ab += v * b;
    }
  }
  if (n < least_seen * a.rows * a.cols) return std::nullopt;
  const double variance_a = aa / n - sum_a / n * (sum_a / n);
  const double variance_b = bb / n - sum_b / n * (sum_b / n);
  constexpr double least = least_texture * least_texture;
  if (variance_a < least || variance_b < least) return std::nullopt;
  return (ab / n - sum_a / n * (sum_b / n)) / std::sqrt(variance_a * variance_b);
}

}  // namespace

PhotometricAgreement::PhotometricAgreement(const Rig& rig)
    : rig_(rig), small_(shrunk(rig.color)), small_lens_(small_) {
  for (const RgbdCamera& camera : rig.rgbd) {
    cameras_.push_back({Lens(camera.color), RayTable::of(camera.depth)});
  }
}

std::optional<double> PhotometricAgreement::of(const FrameSet& frame, const Poses& poses,
                                               std::size_t index) {
  const RgbdFrame& rgbd = frame.rgbd[index];
  if (frame.color.empty() || !rgbd.available() || !poses.color_from_depth[index]) {
    return std::nullopt;
  }
  const Camera& camera = cameras_[index];
  const RgbdCamera& parameters = rig_.rgbd[index];
  const RigidTransform& user_from_depth = *poses.color_from_depth[index];
  cv::Mat own = grey_of(rgbd.color);
  // Blurred to the sharpness of the small picture.
  cv::blur(own, own, {3, 3});
  cv::Mat drawn(small_.height, small_.width, CV_32F, cv::Scalar(-1));
  cv::Mat nearest(small_.height, small_.width, CV_32F,
                  cv::Scalar(std::numeric_limits<float>::infinity()));
  for (int y = 0; y < rgbd.depth.height(); ++y) {
    for (int x = 0; x < rgbd.depth.width(); ++x) {
      if (rgbd.depth(x, y) == 0) continue;
      const double z = rgbd.depth(x, y) * parameters.depth_unit_m;
      const Eigen::Vector3d p = z * (*camera.depth_rays)(x, y).cast<double>().homogeneous();
      const Eigen::Vector3d in_user = user_from_depth * p;
      const auto to = small_lens_.project(in_user);
      if (!to) continue;
      const int u = static_cast<int>(std::lround(to->x()));
      const int v = static_cast<int>(std::lround(to->y()));
      if (!small_.bounds().contains(u, v)) continue;
      // Something nearer hides what is behind it.
      auto& front = nearest.at<float>(v, u);
      if (static_cast<float>(in_user.z()) > front) continue;
      const auto from = camera.color_lens.project(parameters.color_from_depth * p);
      if (!from) continue;
      const int i = static_cast<int>(std::lround(from->x()));
      const int j = static_cast<int>(std::lround(from->y()));
      if (!parameters.color.bounds().contains(i, j)) continue;
      front = static_cast<float>(in_user.z());
      drawn.at<float>(v, u) = own.at<float>(j, i);
    }
  }
  cv::Mat picture;
  cv::resize(grey_of(frame.color), picture, {small_.width, small_.height}, 0, 0, cv::INTER_AREA);
  std::vector<double> correlations;
  for (int y = 0; y + block <= small_.height; y += block / 2) {
    for (int x = 0; x + block <= small_.width; x += block / 2) {
      const cv::Rect part(x, y, block, block);
      if (const auto value = correlate(picture(part), drawn(part))) correlations.push_back(*value);
    }
  }
  if (correlations.size() < least_blocks) return std::nullopt;
  return median(correlations);
}

}  // namespace diminish
