#include "diminish/rig_calibration.h"

#include <fmt/format.h>

#include <algorithm>

#include "diminish/error.h"
#include "pose/depth_check.h"
#include "pose/known_markers.h"
#include "setup/calibrate/depth_alignment.h"
#include "setup/calibrate/fixed_pose_fit.h"
#include "setup/calibrate/target_view.h"

namespace diminish {
namespace {

struct Camera {
  RgbdCamera rgbd;
  Lens color_lens, depth_lens;
  DepthAlignment depth;
  FixedPoseFit fixed;
};

/// Where both poses may be right, chooses the one that the measured depth agrees with.
void settle_by_depth(const Camera& camera, ImageView<std::uint16_t> depth, TargetView& view) {
  if (!view.doubtful || view.id == TargetView::board_id) return;
  const RigidTransform depth_from_color = camera.rgbd.color_from_depth.inverse();
  const auto error = [&](const RigidTransform& pose) {
    return marker_depth_error_m(depth_from_color * pose, 2 * view.high.x(), camera.depth_lens,
                                depth, camera.rgbd.depth_unit_m);
  };
  const auto best = error(view.camera_from_target);
  const auto other = error(view.alternative);
  if (!best || !other) return;
  if (*other < *best) std::swap(view.camera_from_target, view.alternative);
  // Where they are nearly equal, the other cameras may decide better.
  view.doubtful = std::min(*best, *other) > 0.5 * std::max(*best, *other);
}

}  // namespace

struct RigCalibration::Implementation {
  Rig rig;
  Lens color_lens;
  TargetFinder finder;
  std::vector<Camera> cameras;
};

RigCalibration::RigCalibration(const Rig& rig, const Scene& scene,
                               const std::optional<Board>& board) {
  const auto sizes = known_marker_sizes(scene);
  if (!board && sizes.empty()) {
    throw Error(Error::input,
                "scene.yaml: expected a marker of known size (world_marker), or --board");
  }
  implementation_ = std::make_unique<Implementation>(Implementation{
      rig, Lens(rig.color), TargetFinder(scene.marker_dictionary, sizes, board), {}});
  for (const RgbdCamera& rgbd : rig.rgbd) {
    const Lens color_lens(rgbd.color);
    const Lens depth_lens(rgbd.depth);
    implementation_->cameras.push_back(
        {rgbd, color_lens, depth_lens,
         DepthAlignment(depth_lens, rgbd.depth_unit_m, rgbd.color_from_depth),
         FixedPoseFit(implementation_->color_lens, color_lens)});
  }
}
RigCalibration::~RigCalibration() = default;
RigCalibration::RigCalibration(RigCalibration&&) noexcept = default;
RigCalibration& RigCalibration::operator=(RigCalibration&&) noexcept = default;

void RigCalibration::add(const FrameSet& frame) {
  Implementation& self = *implementation_;
  std::vector<TargetView> in_color;
  if (!frame.color.empty()) in_color = self.finder.find(frame.color, self.color_lens);
  for (std::size_t k = 0; k < self.cameras.size(); ++k) {
    Camera& camera = self.cameras[k];
    if (!frame.rgbd[k].has_picture()) continue;
    for (TargetView& view : self.finder.find(frame.rgbd[k].color, camera.color_lens)) {
      camera.depth.add(view, frame.rgbd[k].depth);
      settle_by_depth(camera, frame.rgbd[k].depth, view);
      const auto same = std::find_if(in_color.begin(), in_color.end(),
                                     [&](const TargetView& other) { return other.id == view.id; });
      if (same != in_color.end()) camera.fixed.add(*same, view);
    }
  }
}

DepthToColor RigCalibration::depth_to_color(std::size_t index) const {
  const Camera& camera = implementation_->cameras[index];
  if (camera.depth.size() == 0) {
    throw Error(
        Error::input,
        camera.rgbd.name +
            ": expected markers, or the board, in its colour images, with depth measured on "
            "them: there are none");
  }
  const DepthAlignment::Result solved = camera.depth.solve();
  DepthToColor result{solved.color_from_depth,
                      camera.depth.size(),
                      solved.error_before_m,
                      solved.error_m,
                      solved.undetermined,
                      solved.deviation_m,
                      {}};
  if (solved.determined < 6) {
    std::string list;
    for (const std::string& direction : solved.undetermined) {
      list += (list.empty() ? "" : ", ") + direction;
    }
    result.warnings.push_back(
        fmt::format("{}: the markers determine {} of 6 degrees of freedom, not {}: show them "
                    "leaning left, right, forward and back",
                    camera.rgbd.name, solved.determined, list));
  } else if (solved.deviation_m > 0.005) {
    result.warnings.push_back(fmt::format("{}: uncertain by {:.1f} mm: show more markers",
                                          camera.rgbd.name, 1000 * solved.deviation_m));
  }
  if (solved.error_m > 0.02) {
    result.warnings.push_back(
        fmt::format("{}: depth is {:.0f} mm from the markers' planes even so: depth unit, marker "
                    "size or intrinsics are wrong (see diminish check)",
                    camera.rgbd.name, 1000 * solved.error_m));
  }
  return result;
}

ColorFromRgbd RigCalibration::color_from_rgbd(std::size_t index, const RigidTransform& own) const {
  const Camera& camera = implementation_->cameras[index];
  const auto solved = camera.fixed.solve();
  if (!solved) {
    throw Error(Error::input,
                fmt::format("{}: expected a marker of known size, or the board, that this camera "
                            "and the colour camera see at the same time: there is none",
                            camera.rgbd.name));
  }
  ColorFromRgbd result{
      solved->first_from_second * own, camera.fixed.size(), solved->agreeing,      solved->error_px,
      solved->least_error_px,          solved->deviation_m, solved->deviation_deg, {}};
  const auto warn = [&](const std::string& text) {
    result.warnings.push_back(camera.rgbd.name + ": " + text);
  };
  if (solved->error_px > std::max(0.5, 3 * solved->least_error_px)) {
    warn(
        fmt::format("one transform leaves {:.1f} pixels, a transform for each frame {:.2f}: the "
                    "cameras moved against each other (then leave pose: {{source: marker}}), or "
                    "their intrinsics are wrong",
                    solved->error_px, solved->least_error_px));
  }
  if (2 * solved->agreeing < camera.fixed.size()) {
    warn(fmt::format("only {} of {} sightings agree", solved->agreeing, camera.fixed.size()));
  }
  if (solved->deviation_m > 0.005 || solved->deviation_deg > 0.3) {
    warn(
        fmt::format("uncertain by {:.1f} mm and {:.2f} degrees: show markers in more places, "
                    "larger ones, or a board",
                    1000 * solved->deviation_m, solved->deviation_deg));
  }
  return result;
}

}  // namespace diminish
