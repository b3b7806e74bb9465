#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "beside_peer.h"
#include "core/mat.h"
#include "diminish/frame_source.h"
#include "diminish/options.h"
#include "estimate/plane_sweep/plane_sweep.h"
#include "paths.h"
#include "truth_poses.h"

namespace diminish {
namespace {

constexpr int planes = 64;
constexpr double farthest_m = 3;
/// So that the planes are a pixel of the half-size picture apart.
constexpr double nearest_m = 0.77;

/// The bundled recording's two pictures, where the second camera is, and the first's true depth.
struct Pair {
  Pair()
      : recording(load_recording(std::filesystem::path(testing::recordings_dir()) / "stereo")),
        left(recording.rig.rgbd[0]),
        right(recording.rig.rgbd[1]) {
    FrameSet frame;
    open_recording(recording, Options())->next(frame);
    const Poses poses = TruthPoses(recording.folder).poses(0, recording.rig);
    right_from_left = poses.color_from_depth[1]->inverse() * *poses.color_from_depth[0];
    cv::imread((recording.folder / "truth/depth/left/000000.png").string(), cv::IMREAD_UNCHANGED)
        .convertTo(truth_m, CV_32F, left.depth_unit_m);
    for (std::size_t k = 0; k < 2; ++k) {
      copy(frame.rgbd[k].color.view(), pictures[k]);
      cv::cvtColor(as_mat(pictures[k]), greys[k], cv::COLOR_BGR2GRAY);
      cv::resize(greys[k], greys[k], {left.depth.width, left.depth.height}, 0, 0, cv::INTER_AREA);
    }
  }

  Recording recording;
  RgbdCamera left, right;
  Image<Bgr> pictures[2];
  cv::Mat greys[2];  ///< of the depth image's size
  cv::Mat truth_m;
  RigidTransform right_from_left;
};

/// Of the pixels whose true depth is in the range and in both pictures: the share whose disparity
/// is within two pixels of it. depth_m: what was found for a pixel, 0 if nothing.
template <class Depth>
double share_right(const Pair& pair, const Depth& depth_m) {
  const Intrinsics& view = pair.left.depth;
  const double focal_baseline = view.fx * pair.right_from_left.translation.norm();
  int all = 0;
  int right = 0;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const double z = pair.truth_m.at<float>(y, x);
      if (!(z > nearest_m && z < farthest_m)) continue;
      const Eigen::Vector3d point((x - view.cx) / view.fx * z, (y - view.cy) / view.fy * z, z);
      const Eigen::Vector3d other = pair.right_from_left * point;
      const double u = view.fx * other.x() / other.z() + view.cx;
      if (u < 8 || u >= view.width - 8) continue;
      ++all;
      const double found = depth_m(x, y, point);
      if (found > 0 && focal_baseline * std::abs(1 / found - 1 / z) < 2) ++right;
    }
  }
  return static_cast<double>(right) / all;
}

Intrinsics small_camera(const RgbdCamera& camera) {
  Intrinsics small = camera.depth;
  small.distortion = camera.color.distortion;
  return small;
}

cv::Mat camera_matrix(const Intrinsics& camera) {
  return (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
}

cv::Mat distortion(const Intrinsics& camera) {
  cv::Mat coefficients(1, 5, CV_64F);
  for (int i = 0; i < 5; ++i) {
    coefficients.at<double>(i) = camera.distortion[static_cast<std::size_t>(i)];
  }
  return coefficients;
}

/// 64 planes at 960x540, lens distortion included, beside OpenCV's semi-global matching of the
/// rectified pair over the same range (128 disparities), rectification included.
void plane_sweep_beside_sgbm(benchmark::State& state, int mode) {
  const Pair pair;
  const Intrinsics& view = pair.left.depth;
  GreyPicture left(pair.left.color, 2);
  GreyPicture right(pair.right.color, 2);
  left.take(pair.pictures[0]);
  right.take(pair.pictures[1]);
  PlaneSweep sweep(view);
  Image<float> inverse_depth;

  const cv::Size size(view.width, view.height);
  const Intrinsics first = small_camera(pair.left);
  const Intrinsics second = small_camera(pair.right);
  // OpenCV stores matrices row by row.
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = pair.right_from_left.rotation;
  const cv::Mat rotation = cv::Mat(3, 3, CV_64F, const_cast<double*>(rows.data())).clone();
  const Eigen::Vector3d& t = pair.right_from_left.translation;
  const cv::Mat translation = (cv::Mat_<double>(3, 1) << t.x(), t.y(), t.z());
  cv::Mat turn_left;
  cv::Mat turn_right;
  cv::Mat project_left;
  cv::Mat project_right;
  cv::Mat to_points;
  cv::stereoRectify(camera_matrix(first), distortion(first), camera_matrix(second),
                    distortion(second), size, rotation, translation, turn_left, turn_right,
                    project_left, project_right, to_points, cv::CALIB_ZERO_DISPARITY, 0, size);
  cv::Mat maps[4];
  cv::initUndistortRectifyMap(camera_matrix(first), distortion(first), turn_left, project_left,
                              size, CV_16SC2, maps[0], maps[1]);
  cv::initUndistortRectifyMap(camera_matrix(second), distortion(second), turn_right, project_right,
                              size, CV_16SC2, maps[2], maps[3]);
  const double focal_baseline = std::abs(project_right.at<double>(0, 3));
  const int least = static_cast<int>(focal_baseline / farthest_m) - 1;
  constexpr int block = 5;
  const auto sgbm = cv::StereoSGBM::create(least, 2 * planes, block, 8 * block * block,
                                           32 * block * block, -1, 63, 0, 0, 0, mode);
  cv::Mat rectified[2];
  cv::Mat disparity;
  run_beside_peer(
      state,
      [&] {
        sweep.sweep(left, right, pair.right_from_left, {nearest_m, farthest_m}, view.bounds(),
                    inverse_depth);
      },
      [&] {
        cv::remap(pair.greys[0], rectified[0], maps[0], maps[1], cv::INTER_LINEAR);
        cv::remap(pair.greys[1], rectified[1], maps[2], maps[3], cv::INTER_LINEAR);
        sgbm->compute(rectified[0], rectified[1], disparity);
      });
  state.counters["planes"] = sweep.planes().count;
  state.counters["right"] = share_right(pair, [&](int x, int y, const Eigen::Vector3d&) {
    return inverse_depth(x, y) > 0 ? 1 / static_cast<double>(inverse_depth(x, y)) : 0;
  });
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> turn(
      turn_left.ptr<double>());
  const double focal = project_left.at<double>(0, 0);
  state.counters["peer_right"] = share_right(pair, [&](int, int, const Eigen::Vector3d& point) {
    const Eigen::Vector3d ray = turn * point / point.z();
    const int x =
        static_cast<int>(std::lround(focal * ray.x() / ray.z() + project_left.at<double>(0, 2)));
    const int y =
        static_cast<int>(std::lround(focal * ray.y() / ray.z() + project_left.at<double>(1, 2)));
    if (!view.bounds().contains(x, y)) return 0.0;
    const double found = disparity.at<std::int16_t>(y, x) / 16.0;
    // The rectified camera's depth along the same ray, as the left camera counts it
    return found > 0 ? focal_baseline / found / ray.z() : 0.0;
  });
}

BENCHMARK_CAPTURE(plane_sweep_beside_sgbm, three_way, cv::StereoSGBM::MODE_SGBM_3WAY)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(plane_sweep_beside_sgbm, five_way, cv::StereoSGBM::MODE_SGBM)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace diminish
