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

/// Where an RGB-D camera's depth sensor is, seen from its own colour sensor.
struct DepthToColor {
  RigidTransform color_from_depth;
  std::size_t sightings = 0;  ///< of markers, or of the board, with depth
  /// Root mean square distance of the measured depth from the targets' planes, metres: with what
  /// the rig says, and with the result.
  double error_before_m = 0, error_m = 0;
  /// Directions, of six, that the sightings do not determine; there the rig's values stay.
  std::vector<std::string> undetermined;
  double deviation_m = 0;  ///< standard deviation of the worst one that is determined
  std::vector<std::string> warnings;
};

/// Where an RGB-D camera is, seen from the colour camera.
struct ColorFromRgbd {
  RigidTransform color_from_depth;  ///< from the RGB-D camera's depth frame
  std::size_t sightings = 0;        ///< of markers, or of the board, by both cameras
  std::size_t agreeing = 0;         ///< of these, those that agree with the rest
  double error_px = 0;              ///< root mean square of the corners' reprojection errors
  double least_error_px = 0;  ///< the same if the cameras could be elsewhere for every sighting
  double deviation_m = 0, deviation_deg = 0;  ///< standard deviations
  std::vector<std::string> warnings;
};

/// Calibrates the places of cameras and sensors by markers of known size (those of the scene) or by
/// a board, seen in many frames. Keeps some hundred sightings for each camera.
class DIMINISH_EXPORT RigCalibration {
 public:
  /// board: looked for instead of markers. Throws Error if nothing of known size can be looked for.
  RigCalibration(const Rig& rig, const Scene& scene, const std::optional<Board>& board);
  ~RigCalibration();
  RigCalibration(RigCalibration&&) noexcept;
  RigCalibration& operator=(RigCalibration&&) noexcept;

  void add(const FrameSet& frame);

  /// For the rig's RGB-D camera of this index. Throws Error that names the camera without
  /// sightings. Planes say how the sensors lie to each other only together: six degrees of freedom
  /// need markers that lean in three directions and more.
  DepthToColor depth_to_color(std::size_t camera) const;

  /// The same between cameras. own: the RGB-D camera's color_from_depth.
  ColorFromRgbd color_from_rgbd(std::size_t camera, const RigidTransform& own) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
