#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "detect/object_track.h"
#include "detect/silhouette/polygon_filler.h"
#include "detect/silhouette/polygons.h"
#include "diminish/occluder_detector.h"

namespace diminish {

/// Objects' outlines in the images of OcclusionMasks.
struct OcclusionOutlines {
  Polygons color;
  std::vector<Polygons> rgbd_color, rgbd_depth;
  /// By object: its shape's vertices in the colour camera's frame; none where it is not known.
  std::vector<std::vector<Eigen::Vector3d>> vertices_m;

  /// Empty, for this many RGB-D cameras and objects.
  void clear(std::size_t cameras, std::size_t objects);
};

/// A detector of objects with a known shape. It outlines them, and the MaskDrawer draws its
/// outlines with the others.
class ShapeDetector : public OccluderDetector {
 public:
  /// Adds the object's outlines, labelled `object`, and its vertices, and leaves the others alone.
  /// What they cover is known only after drawing: of the report, fills the name and the message.
  /// track: of this object, to be followed and continued; null if frames stand alone.
  virtual void outline(const Observation& observation, std::uint32_t object, ObjectTrack* track,
                       OcclusionOutlines& outlines, OccluderReport& report) = 0;

  /// Outlines, then draws.
  OccluderReport detect(const Observation& observation, OcclusionMasks& masks) override;

 private:
  OcclusionOutlines outlines_;
  PolygonFiller filler_;
};

}  // namespace diminish
