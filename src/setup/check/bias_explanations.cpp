#include "setup/check/bias_explanations.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "pose/camera_poses.h"
#include "setup/check/photometric_agreement.h"

namespace diminish {
namespace {

using Agreements = std::vector<std::optional<double>>;
using Kind = BiasExplanation::Kind;

/// Poses are measured anew: those from markers depend on the lens.
Agreements agreements_of(const Diagnosis& setup, const Rig& rig, const RigidTransform& correction) {
  CameraPoses camera_poses(rig, setup.scene);
  PhotometricAgreement photometric(rig);
  Agreements all;
  for (const SetupSurvey::Kept& kept : setup.survey.kept) {
    if (kept.frame.color.empty()) continue;
    Poses poses;
    camera_poses.estimate(kept.frame, kept.markers, poses);
    for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
      if (!setup.usable[k]) continue;
      auto& pose = poses.color_from_depth[k];
      if (pose) pose = correction * *pose;
      all.push_back(photometric.of(kept.frame, poses, k));
    }
  }
  return all;
}

/// The rig with some of the colour camera's numbers changed by `by`.
using Change = std::function<Rig(const Eigen::Vector2d& by)>;

/// Goes uphill from `at`, in steps of both numbers that are halved until the last.
Eigen::Vector2d best_change(const Diagnosis& setup, const Change& change, Eigen::Vector2d at,
                            const Eigen::Vector2d& first_step, int halvings) {
  constexpr int most_steps = 40;
  const auto value = [&](const Eigen::Vector2d& by) {
    return mean_agreement(agreements_of(setup, change(by), {}));
  };
  double best = value(at);
  Eigen::Vector2d step = first_step;
  for (int tried = 0; halvings >= 0 && tried < most_steps;) {
    const Eigen::Vector2d before = at;
    for (const double x : {-1., 0., 1.}) {
      for (const double y : {-1., 0., 1.}) {
        const Eigen::Vector2d offset = step.cwiseProduct(Eigen::Vector2d(x, y));
        if ((x != 0) == (y != 0) || offset.isZero()) continue;
        ++tried;
        const double found = value(before + offset);
        if (found <= best) continue;
        best = found;
        at = before + offset;
      }
    }
    if (at != before) continue;
    step /= 2;
    --halvings;
  }
  return at;
}

BiasExplanation as_pose(const Diagnosis& setup, const RigidTransform& refinement) {
  return {Kind::pose, "that pose", agreements_of(setup, setup.rig, refinement)};
}

BiasExplanation as_principal_point(const Diagnosis& setup, const RigidTransform& refinement) {
  const Change change = [&](const Eigen::Vector2d& by) {
    Rig rig = setup.rig;
    rig.color.cx += by.x();
    rig.color.cy += by.y();
    return rig;
  };
  // A turn looks much like a shift of the principal point.
  const Eigen::AngleAxisd turn(refinement.rotation);
  const Eigen::Vector3d vector = turn.angle() * turn.axis();
  const Eigen::Vector2d shift(setup.rig.color.fx * vector.y(), -setup.rig.color.fy * vector.x());
  const double step_px = setup.rig.color.width / 160.;
  const Rig rig = change(best_change(setup, change, shift, {step_px, step_px}, 2));
  return {Kind::principal_point,
          fmt::format("a principal point of ({:.0f}, {:.0f})", rig.color.cx, rig.color.cy),
          agreements_of(setup, rig, {})};
}

BiasExplanation as_focal_length(const Diagnosis& setup) {
  const Change change = [&](const Eigen::Vector2d& by) {
    Rig rig = setup.rig;
    rig.color.fx *= 1 + by.x();
    rig.color.fy *= 1 + by.x();
    return rig;
  };
  const Rig rig = change(best_change(setup, change, {0, 0}, {0.02, 0}, 3));
  return {Kind::focal_length, fmt::format("a focal length of {:.0f} pixels", rig.color.fx),
          agreements_of(setup, rig, {})};
}

BiasExplanation as_distortion(const Diagnosis& setup) {
  const Change change = [&](const Eigen::Vector2d& by) {
    Rig rig = setup.rig;
    rig.color.distortion[0] += by.x();
    return rig;
  };
  const Rig rig = change(best_change(setup, change, {0, 0}, {0.08, 0}, 3));
  return {Kind::distortion,
          fmt::format("a first distortion coefficient of {:.2f}", rig.color.distortion[0]),
          agreements_of(setup, rig, {})};
}

}  // namespace

double mean_agreement(const Agreements& agreements) {
  double sum = 0;
  int count = 0;
  for (const auto& agreement : agreements) {
    if (!agreement) continue;
    sum += *agreement;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

Agreements agreements_as_is(const Diagnosis& setup) {
  return agreements_of(setup, setup.rig, {});
}

std::vector<BiasExplanation> explain_bias(const Diagnosis& setup,
                                          const RigidTransform& refinement) {
  std::vector<BiasExplanation> all = {as_pose(setup, refinement),
                                      as_principal_point(setup, refinement), as_focal_length(setup),
                                      as_distortion(setup)};
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return mean_agreement(a.agreements) > mean_agreement(b.agreements);
  });
  return all;
}

bool is_better(const BiasExplanation& a, const BiasExplanation& b) {
  constexpr double least_standard_errors = 2;
  /// Numbers that were looked for fit a little better than what was measured.
  constexpr double least = 0.005;
  std::vector<double> differences;
  for (std::size_t i = 0; i < std::min(a.agreements.size(), b.agreements.size()); ++i) {
    if (a.agreements[i] && b.agreements[i]) {
      differences.push_back(*a.agreements[i] - *b.agreements[i]);
    }
  }
  if (differences.size() < 2) return false;
  const auto count = static_cast<double>(differences.size());
  const double mean = std::accumulate(differences.begin(), differences.end(), 0.) / count;
  double squares = 0;
  for (const double difference : differences) squares += (difference - mean) * (difference - mean);
  return mean > least && mean > least_standard_errors * std::sqrt(squares / (count - 1) / count);
}

}  // namespace diminish
