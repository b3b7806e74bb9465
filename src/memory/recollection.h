#pragma once

#include <memory>
#include <vector>

#include "diminish/options.h"
#include "diminish/reconstructor.h"
#include "memory/torn_edges.h"
#include "memory/witness.h"
#include "pose/pose_refinement.h"
#include "scene/color_maps.h"

namespace diminish {

/// What there is of a frame when something is to be remembered in it.
struct RecallInputs {
  const FrameSet& frame;
  const Poses& poses;  ///< refined; color_from_world is known
  const OcclusionMasks& masks;
  const Rect& objects;           ///< their box in the picture
  const TiledRegion& region;     ///< that is drawn
  ColorMapsBySource color_maps;  ///< of the RGB-D cameras
  const Options& options;
};

/// Draws a keyframe as an RGB-D camera's images, from the viewpoint of another frame.
class Recollection {
 public:
  Recollection(const Rig& rig, const KeyframeGrid& grid);

  /// Aligns the keyframe with the frame's picture (the same camera: to a tenth of a pixel), finds
  /// its gain, and what has changed since. now: this frame's testimonies.
  void prepare(std::shared_ptr<const Keyframe> keyframe, const RecallInputs& inputs,
               const std::vector<Testimony>& now);
  /// Draws what has not changed.
  void draw(const RecallInputs& inputs);

  const Reconstruction& drawn() const { return drawn_; }
  const Keyframe& keyframe() const { return *keyframe_; }
  /// From the keyframe's colours to the frame's.
  const ColorMap& color_map() const { return color_maps_.by_source()[1]; }
  const Witness& witness() const { return witness_; }
  /// How far the user's camera has moved since.
  double baseline_m() const { return poses_.color_from_depth[0]->translation.norm(); }
  /// Witness::judge.
  const std::vector<Eigen::Vector3f>& gone() const { return gone_; }

 private:
  Rig rig_;  ///< the user's camera, and the keyframe
  int grid_step_;
  PoseRefinement coarse_, fine_;
  ColorMaps color_maps_;
  Witness witness_;
  std::unique_ptr<Reconstructor> drawer_;
  std::shared_ptr<const Keyframe> keyframe_;  ///< `frame_` shows its picture
  FrameSet frame_;
  DepthImages depth_;
  Poses poses_;
  OcclusionMasks masks_;  ///< all clear: the keyframe's depth has no objects
  SceneSamples samples_;
  std::vector<Eigen::Vector3f> gone_;
  Reconstruction drawn_;
  TornEdges edges_;
};

}  // namespace diminish
