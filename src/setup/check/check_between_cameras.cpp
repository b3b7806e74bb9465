#include "setup/check/setup_checks.h"

#include <fmt/format.h>

#include "pose/camera_poses.h"

namespace diminish {
namespace {

using Severity = Finding::Severity;

/// Whether a camera with fixed poses is where another one should be.
bool check_swapped_cameras(Diagnosis& setup, std::size_t k, double most_px) {
  CameraPoses camera_poses(setup.rig, setup.scene);
  const Lens color_lens(setup.rig.color);
  const Lens rgbd_lens(setup.rig.rgbd[k].color);
  for (std::size_t other = 0; other < setup.rig.rgbd.size(); ++other) {
    if (other == k) continue;
    std::vector<double> errors;
    for (const SetupSurvey::Kept& kept : setup.survey.kept) {
      Poses poses;
      camera_poses.estimate(kept.frame, kept.markers, poses);
      if (!poses.color_from_depth[other]) continue;
      const RigidTransform color_from_rgbd =
          *poses.color_from_depth[other] * setup.rig.rgbd[k].color_from_depth.inverse();
      const auto more = errors_between(kept.markers.color, kept.markers.rgbd[k], setup.sizes,
                                       color_lens, rgbd_lens, color_from_rgbd);
      errors.insert(errors.end(), more.begin(), more.end());
    }
    if (errors.empty() || median_of(errors) > most_px) continue;
    setup.find(
        Severity::serious, "swapped",
        fmt::format("{} is where {} should be: they are swapped", setup.rig.rgbd[k].name,
                    setup.rig.rgbd[other].name),
        fmt::format("markers agree to {:.1f} pixels with the pose of {}, to {:.1f} with its own",
                    median_of(errors), setup.rig.rgbd[other].name,
                    median_of(setup.survey.between_px[k])),
        "swap the cameras' names, in the recording or the driver");
    setup.explained = true;
    return true;
  }
  return false;
}

}  // namespace

void check_between_cameras(Diagnosis& setup) {
  const bool fixed = setup.rig.pose_source == "fixed";
  const double most = (fixed ? 0.008 : 0.025) * setup.rig.color.width;
  for (std::size_t k = 0; k < setup.rig.rgbd.size(); ++k) {
    if (!setup.usable[k] || setup.survey.between_px[k].empty()) continue;
    const double error = median_of(setup.survey.between_px[k]);
    setup.note(
        fmt::format("reprojection error of markers from {} to color", setup.rig.rgbd[k].name),
        error, "pixels");
    if (error < most || (setup.explained && !fixed)) continue;
    if (fixed && check_swapped_cameras(setup, k, most)) continue;
    setup.explained = true;
    setup.find(Severity::serious, "disagreement",
               fmt::format("{} and color disagree on where markers are", setup.rig.rgbd[k].name),
               fmt::format("{:.1f} pixels", error),
               fixed ? "if cameras were moved, run diminish calibrate rig"
                     : "use a larger world marker, tilted more; calibrate the cameras");
  }
}

}  // namespace diminish
