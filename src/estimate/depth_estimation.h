#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "diminish/depth_estimator.h"
#include "estimate/given_planes.h"

namespace diminish {

/// Gives depth images to cameras that measure none; the stages that follow see no difference.
class DepthEstimation {
 public:
  DepthEstimation(const Rig& rig, const Scene& scene)
      : rig_(rig), scene_(scene), given_planes_(rig, scene) {}

  /// Throws Error if the method cannot work with this rig and scene.
  void choose(const std::string& method);

  /// The frame, in which cameras that measure none have depth images, of zeros as yet; itself where
  /// all cameras measure depth. It is valid until the next call.
  const FrameSet& begin(const FrameSet& frame);
  /// Fills in the depth images of that frame.
  void estimate(const Markers& markers, const Poses& poses, const OcclusionMasks& masks,
                const Rect& drawn, const Options& options);
  /// For a rig without any RGB-D camera: the scene's planes in the user's camera's frame. Empty for
  /// others, or without planes. It is valid until the next call.
  std::span<const InversePlane> own_planes(const Markers& markers, const Poses& poses);
  /// Whether the frame's markers are asked for.
  bool needs_markers() const;
  /// What hindered it in this frame.
  const std::vector<std::string>& messages() const { return messages_; }

 private:
  bool is_needed() const;

  Rig rig_;
  Scene scene_;
  std::string method_;
  std::unique_ptr<DepthEstimator> estimator_;
  GivenPlanes given_planes_;
  std::vector<GivenPlanes::Found> found_;
  std::vector<InversePlane> own_planes_;
  FrameSet frame_;
  std::vector<bool> wanted_;
  std::vector<Image<std::uint16_t>> depths_;
  std::vector<std::string> messages_;
};

}  // namespace diminish
