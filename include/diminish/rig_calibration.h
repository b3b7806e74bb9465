#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diminish/board.h"
#include "diminish/export.h"
#include "diminish/frame_set.h"
#include "diminish/rig.h"
#include "diminish/rigid_transform.h"
#include "diminish/scene.h"

namespace diminish {

/// The pose of an RGB-D camera's depth sensor relative to its own colour sensor.
struct DepthToColor {
  RigidTransform color_from_depth;
  std::size_t sightings = 0;  ///< of markers or the board, with depth
  /// Root mean square distance of the measured depth from the targets' planes, metres: with the
  /// rig's values and with the result.
  double error_before_m = 0, error_m = 0;
  /// Those of the six degrees of freedom that the sightings do not determine. They keep the rig's
  /// values.
  std::vector<std::string> undetermined;
  double deviation_m = 0;  ///< standard deviation of the worst one that is determined
  std::vector<std::string> warnings;
};

/// The pose of an RGB-D camera relative to the colour camera.
struct ColorFromRgbd {
  RigidTransform color_from_depth;  ///< from the RGB-D camera's depth frame
  std::size_t sightings = 0;        ///< of markers or the board, by both cameras
  std::size_t agreeing = 0;         ///< of these, those that agree with the rest
  double error_px = 0;              ///< root mean square of the corners' reprojection errors
  double least_error_px = 0;        ///< the same with a separate pose for every sighting
  double deviation_m = 0, deviation_deg = 0;  ///< standard deviations
  std::vector<std::string> warnings;
};

/// Calibrates the poses of cameras and sensors from markers of known size (the scene's) or a board,
/// seen in many frames. Keeps a few hundred sightings for each camera.
class DIMINISH_EXPORT RigCalibration {
 public:
  /// board: used instead of markers. Throws Error if there is nothing of known size to look for.
  RigCalibration(const Rig& rig, const Scene& scene, const std::optional<Board>& board);
  ~RigCalibration();
  RigCalibration(RigCalibration&&) noexcept;
  RigCalibration& operator=(RigCalibration&&) noexcept;

  void add(const FrameSet& frame);

  /// For the rig's RGB-D camera with this index. Throws Error that names the camera if it has no
  /// sightings. A plane determines only three of six degrees of freedom, so markers must be tilted
  /// in at least three directions.
  DepthToColor depth_to_color(std::size_t camera) const;

  /// The same between cameras. own: the RGB-D camera's color_from_depth.
  ColorFromRgbd color_from_rgbd(std::size_t camera, const RigidTransform& own) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
