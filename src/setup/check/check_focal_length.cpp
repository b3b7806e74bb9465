#include "setup/check/check_focal_length.h"

#include <fmt/format.h>

#include <cmath>

#include "pose/camera_poses.h"
#include "setup/check/photometric_agreement.h"
#include "setup/check/setup_checks.h"

namespace diminish {
namespace {

constexpr double least_agreement = 0.4;  ///< below this the pictures do not agree at all
constexpr double focal_tolerance = 0.04;

}  // namespace

Rig with_focal_length(Rig rig, std::size_t sensor, double factor) {
  Intrinsics& camera = color_sensor(rig, sensor);
  camera.fx *= factor;
  camera.fy *= factor;
  return rig;
}

std::optional<double> agreement(const Diagnosis& setup, const Rig& rig, const Scene& scene) {
  CameraPoses camera_poses(rig, scene);
  PhotometricAgreement photometric(rig);
  double sum = 0;
  std::size_t count = 0;
  for (const SetupSurvey::Kept& kept : setup.survey.kept) {
    if (kept.frame.color.empty()) continue;
    Poses poses;
    camera_poses.estimate(kept.frame, kept.markers, poses);
    for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
      if (!setup.usable[k]) continue;
      if (const auto value = photometric.of(kept.frame, poses, k)) {
        sum += *value;
        ++count;
      }
    }
  }
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

void blame_focal_length(Diagnosis& setup, std::size_t sensor, double factor,
                        const std::string& figure) {
  const Intrinsics& camera = color_sensor(setup.rig, sensor);
  setup.find(Finding::Severity::serious, "intrinsics",
             fmt::format("the focal length of {} is wrong: about {:.0f} pixels rather than {:.0f}",
                         setup.sensors()[sensor]->name, camera.fx * factor, camera.fx),
             figure,
             fmt::format("diminish calibrate intrinsics --camera {}",
                         sensor == 0 ? "color" : setup.rig.rgbd[sensor - 1].name + "_color"));
  setup.rig = with_focal_length(setup.rig, sensor, factor);
  setup.explained = true;
}

void check_focal_length(Diagnosis& setup) {
  const auto as_is = agreement(setup, setup.rig, setup.scene);
  if (!as_is) return;
  setup.note("photometric agreement (correlation of the cameras' pictures)", *as_is, "");
  if (setup.explained) return;
  double best = *as_is;
  double best_factor = 1;
  for (const double factor :
       {0.82, 0.86, 0.89, 0.91, 0.93, 0.95, 0.97, 1.03, 1.05, 1.07, 1.1, 1.13, 1.17, 1.22}) {
    const auto value = agreement(setup, with_focal_length(setup.rig, 0, factor), setup.scene);
    if (!value || *value <= best) continue;
    best = *value;
    best_factor = factor;
  }
  if (best < least_agreement || best < *as_is + least_improvement ||
      std::abs(best_factor - 1) < focal_tolerance) {
    return;
  }
  blame_focal_length(
      setup, 0, best_factor,
      fmt::format("then the cameras' pictures agree by {:.2f}, now by {:.2f}", best, *as_is));
}

}  // namespace diminish
