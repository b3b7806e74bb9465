#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "diminish/pipeline.h"
#include "pose/camera_poses.h"
#include "setup/check/photometric_agreement.h"
#include "setup/check/setup_checks.h"

namespace diminish {
namespace {

constexpr double degrees = 180 / std::numbers::pi;
constexpr std::size_t least_frames = 3;
/// What is less does no harm: the refinement takes it away.
constexpr double most_turned_deg = 0.5;
constexpr double most_moved_m = 0.01;
/// One marker leaves that much open, the same way in every frame where nothing moves.
constexpr double most_turned_by_marker_deg = 1;
constexpr double most_moved_by_marker_m = 0.024;
/// A mean that is fewer standard errors long may be noise of each frame's pose.
constexpr double least_standard_errors = 3;

using Vector6 = Eigen::Matrix<double, 6, 1>;  ///< rotation vector, translation

struct Moved {
  const SetupSurvey::Kept* frame;
  Poses measured;
  Vector6 by;  ///< the refinement, in the colour camera's frame
};

/// How the refinement moves the colour camera in the frames that were kept.
std::vector<Moved> refinements(const Diagnosis& setup) {
  Options options;
  options.memory = "off";
  options.color_correct = "none";
  options.inpaint = "none";
  options.whole_view = true;
  Pipeline pipeline(setup.rig, setup.scene, options);
  pipeline.want_reconstruction(false);
  CameraPoses camera_poses(setup.rig, setup.scene);
  DiminishedFrame result;
  std::vector<Moved> all;
  for (const SetupSurvey::Kept& kept : setup.survey.kept) {
    if (kept.frame.color.empty()) continue;
    Poses measured;
    camera_poses.estimate(kept.frame, kept.markers, measured);
    pipeline.process(kept.frame, result);
    for (std::size_t k = 0; k < setup.rig.rgbd.size(); ++k) {
      const auto& refined = result.report.poses.color_from_depth[k];
      if (!measured.color_from_depth[k] || !refined) continue;
      const RigidTransform by = *refined * measured.color_from_depth[k]->inverse();
      const Eigen::AngleAxisd turn(by.rotation);
      Vector6 moved;
      moved << turn.angle() * turn.axis(), by.translation;
      all.push_back({&kept, measured, moved});
      break;
    }
  }
  return all;
}

RigidTransform transform_of(const Vector6& moved) {
  const Eigen::Vector3d turn = moved.head<3>();
  const double angle = turn.norm();
  const Eigen::Vector3d axis = angle > 0 ? Eigen::Vector3d(turn / angle) : Eigen::Vector3d::UnitX();
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), moved.tail<3>()};
}

/// How well the cameras' pictures agree if the colour camera is moved in each frame.
double agreement(const Diagnosis& setup, const Rig& rig, const std::vector<Moved>& frames,
                 const Vector6& by) {
  PhotometricAgreement photometric(rig);
  const RigidTransform correction = transform_of(by);
  double sum = 0;
  std::size_t count = 0;
  for (const Moved& frame : frames) {
    Poses poses = frame.measured;
    for (auto& pose : poses.color_from_depth) {
      if (pose) pose = correction * *pose;
    }
    for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
      if (!setup.usable[k]) continue;
      if (const auto value = photometric.of(frame.frame->frame, poses, k)) {
        sum += *value;
        ++count;
      }
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

}  // namespace

void check_pose_bias(Diagnosis& setup) {
  if (setup.explained) return;
  const std::vector<Moved> frames = refinements(setup);
  if (frames.size() < least_frames) return;
  Vector6 mean = Vector6::Zero();
  for (const Moved& frame : frames) mean += frame.by / static_cast<double>(frames.size());
  double turn_variance = 0;
  double move_variance = 0;
  for (const Moved& frame : frames) {
    turn_variance += (frame.by - mean).head<3>().squaredNorm() / static_cast<double>(frames.size());
    move_variance += (frame.by - mean).tail<3>().squaredNorm() / static_cast<double>(frames.size());
  }
  const auto is_bias = [&](double length, double variance) {
    return length >
           least_standard_errors * std::sqrt(variance / static_cast<double>(frames.size()));
  };
  const double turned_deg = mean.head<3>().norm() * degrees;
  const double moved_m = mean.tail<3>().norm();
  setup.note("refinement turns the colour camera, in every frame alike", turned_deg, "degrees");
  setup.note("refinement moves the colour camera, in every frame alike", moved_m * 1000, "mm");
  const bool by_marker = setup.rig.pose_source == "marker";
  const bool turns = turned_deg > (by_marker ? most_turned_by_marker_deg : most_turned_deg) &&
                     is_bias(mean.head<3>().norm(), turn_variance);
  const bool moves = moved_m > (by_marker ? most_moved_by_marker_m : most_moved_m) &&
                     is_bias(moved_m, move_variance);
  if (!turns && !moves) return;

  // A turn looks much like a shift of the principal point.
  Rig shifted = setup.rig;
  const double dx = setup.rig.color.fx * mean(1);
  const double dy = -setup.rig.color.fy * mean(0);
  shifted.color.cx += dx;
  shifted.color.cy += dy;
  const double as_is = agreement(setup, setup.rig, frames, Vector6::Zero());
  const double by_pose = agreement(setup, setup.rig, frames, mean);
  const double by_center = agreement(setup, shifted, frames, Vector6::Zero());
  setup.find(
      Finding::Severity::warning, "pose-bias",
      "the colour camera's pose is wrong in the same way in every frame",
      fmt::format("refinement turns it by {:.1f} degrees and moves it by {:.0f} mm; with that the "
                  "cameras' pictures agree by {:.2f}, as they are by {:.2f}, with the colour "
                  "camera's principal point at ({:.0f}, {:.0f}) by {:.2f}",
                  turned_deg, moved_m * 1000, by_pose, as_is, shifted.color.cx, shifted.color.cy,
                  by_center),
      by_center > by_pose
          ? "diminish calibrate intrinsics --camera color"
          : "measure again how the tracker or marker is mounted: diminish calibrate rig");
}

}  // namespace diminish
