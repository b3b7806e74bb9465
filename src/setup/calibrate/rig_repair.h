#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/rig.h"
#include "diminish/rigid_transform.h"
#include "diminish/scene.h"

namespace diminish {

/// Where an RGB-D camera is now that was moved since its fixed pose was calibrated.
struct RepairedPose {
  std::string camera;
  /// From the frame that its pose is given for, usually its depth frame, to the colour camera's.
  RigidTransform color_from_rgbd;
  double turned_deg = 0, moved_m = 0;  ///< from the pose that it had, about its own centre
  /// How well what it sees fits the colour camera's pictures (SceneFit): as it was, and with this.
  double fit_before = 0, fit = 0;
};

/// Finds fixed poses again from pictures alone, no marker or board needed: what an RGB-D camera
/// sees, drawn into the colour camera's picture, must look like it. Looks for turns of up to 4
/// degrees, then for all six degrees of freedom; a pose along which the picture hardly changes (the
/// viewing direction, before a plain wall) stays about as it was.
class RigRepair {
 public:
  /// Throws Error unless the rig's poses are fixed.
  RigRepair(const Rig& rig, const Scene& scene);
  ~RigRepair();
  RigRepair(const RigRepair&) = delete;
  RigRepair& operator=(const RigRepair&) = delete;

  static constexpr std::size_t most_frames = 12;
  /// Copies what it needs of a frame; a few are enough, and further ones are not looked at, nor are
  /// those without all cameras' images. Objects to remove are left out.
  void add(const FrameSet& frame);
  std::size_t frames() const;

  /// One for each RGB-D camera. About a second each. Throws Error that names the camera if it had
  /// no images, or too little of what it sees is in the pictures.
  std::vector<RepairedPose> repair() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
