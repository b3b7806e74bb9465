#pragma once

#include <vector>

#include "memory/keyframe.h"
#include "scene/scene_sampler.h"

namespace diminish {

/// Finds once what every recall of a keyframe needs.
class KeyframePreparation {
 public:
  KeyframePreparation(const Rig& rig, const KeyframeGrid& grid);

  /// Fills `sights`, `overview_m` and `samples`. Cost: 20 ns a place.
  void prepare(Keyframe& keyframe);

 private:
  void find_sights(Keyframe& keyframe, std::size_t camera) const;
  void find_samples(Keyframe& keyframe);

  KeyframeGrid grid_;
  std::vector<TestimonyGrid> testimony_grids_;  ///< of each RGB-D camera
  SceneSampler sampler_;
  OcclusionMasks masks_;
  SceneSamples samples_;
};

/// The keyframe as an RGB-D camera of a rig: its picture and its grid's depth, the masks of objects
/// in them (none), and its images, which must outlive the frame's.
Rig keyframe_rig(const Rig& rig, const KeyframeGrid& grid);
OcclusionMasks keyframe_masks(const Rig& rig, const KeyframeGrid& grid);
void show(const Keyframe& keyframe, FrameSet& frame);

}  // namespace diminish
