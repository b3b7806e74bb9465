#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "diminish/pipeline.h"
#include "pose/camera_poses.h"
#include "setup/check/bias_explanations.h"
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

/// What brings back less of the agreement than this share of the best is not the cause.
constexpr double worth_naming = 0.5;

using Vector6 = Eigen::Matrix<double, 6, 1>;  ///< rotation vector, translation

/// How the refinement moves the colour camera, in its own frame, in the frames that were kept.
std::vector<Vector6> refinements(const Diagnosis& setup) {
  Options options;
  options.memory = "off";
  options.color_correct = "none";
  options.inpaint = "none";
  options.whole_view = true;
  Pipeline pipeline(setup.rig, setup.scene, options);
  pipeline.want_reconstruction(false);
  CameraPoses camera_poses(setup.rig, setup.scene);
  DiminishedFrame result;
  std::vector<Vector6> all;
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
      all.push_back(moved);
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

/// ", with a principal point of (639, 504) by 0.50"
std::string figures_of(const std::vector<BiasExplanation>& explanations) {
  std::string text;
  for (const BiasExplanation& explanation : explanations) {
    text += fmt::format(", with {} by {:.2f}", explanation.corrected,
                        mean_agreement(explanation.agreements));
  }
  return text;
}

std::string name_of(BiasExplanation::Kind kind) {
  switch (kind) {
    case BiasExplanation::Kind::pose:
      return "pose";
    case BiasExplanation::Kind::principal_point:
      return "principal point";
    case BiasExplanation::Kind::focal_length:
      return "focal length";
    case BiasExplanation::Kind::distortion:
      return "distortion";
  }
  return {};
}

}  // namespace

void check_pose_bias(Diagnosis& setup) {
  if (setup.explained) return;
  const std::vector<Vector6> frames = refinements(setup);
  if (frames.size() < least_frames) return;
  Vector6 mean = Vector6::Zero();
  for (const Vector6& by : frames) mean += by / static_cast<double>(frames.size());
  double turn_variance = 0;
  double move_variance = 0;
  for (const Vector6& by : frames) {
    turn_variance += (by - mean).head<3>().squaredNorm() / static_cast<double>(frames.size());
    move_variance += (by - mean).tail<3>().squaredNorm() / static_cast<double>(frames.size());
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

  const std::vector<BiasExplanation> explanations = explain_bias(setup, transform_of(mean));
  const BiasExplanation& best = explanations.front();
  const double as_is = mean_agreement(agreements_as_is(setup));
  const double best_gained = mean_agreement(best.agreements) - as_is;
  std::string cause = name_of(best.kind);
  bool may_be_pose = !best.is_lens();
  bool may_be_lens = best.is_lens();
  for (std::size_t i = 1; i < explanations.size(); ++i) {
    const double gained = mean_agreement(explanations[i].agreements) - as_is;
    if (is_better(best, explanations[i]) || gained < worth_naming * best_gained) continue;
    cause += " or " + name_of(explanations[i].kind);
    (explanations[i].is_lens() ? may_be_lens : may_be_pose) = true;
  }
  const std::string calibrate_lens = "diminish calibrate intrinsics --camera color";
  const std::string calibrate_pose =
      "measure again how the tracker or marker is mounted: diminish calibrate rig";
  setup.find(Finding::Severity::warning, "pose-bias",
             "the colour camera's " + cause + " is wrong, in the same way in every frame",
             fmt::format("refinement turns it by {:.1f} degrees and moves it by {:.0f} mm; the "
                         "cameras' pictures agree by {:.2f}{}",
                         turned_deg, moved_m * 1000, as_is, figures_of(explanations)),
             !may_be_lens   ? calibrate_pose
             : !may_be_pose ? calibrate_lens
                            : calibrate_lens + "; if that changes little, " + calibrate_pose);
}

}  // namespace diminish
