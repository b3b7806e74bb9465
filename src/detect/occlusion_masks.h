#pragma once

#include <memory>
#include <string>
#include <vector>

#include "detect/disc_dilation.h"
#include "diminish/occluder_detector.h"

namespace diminish {

/// Finds all of a scene's objects to remove.
class OccluderStage {
 public:
  /// Throws Error on unknown detectors and wrong settings.
  OccluderStage(const Rig& rig, const Scene& scene);

  /// Whether the observation must hold the markers of the colour images.
  bool needs_markers() const;

  /// Replaces `masks` by the union of all objects' masks in this frame, grown by the options'
  /// margins, and `reports` by one report for each object. Those that the option `keep` names are
  /// not looked for.
  void detect(const Observation& observation, OcclusionMasks& masks,
              std::vector<OccluderReport>& reports);

 private:
  void clear(OcclusionMasks& masks) const;
  void grow_by_margins(const Options& options, double deviation_px, OcclusionMasks& masks);

  Rig rig_;
  std::vector<std::unique_ptr<OccluderDetector>> detectors_;
  std::vector<std::string> names_;       ///< of the objects
  std::vector<DiscDilation> dilations_;  ///< of the colour camera, and each RGB-D camera
};

}  // namespace diminish
