#pragma once

#include <cstdint>
#include <vector>

#include "detect/silhouette/polygon_filler.h"
#include "detect/silhouette/polygons.h"
#include "diminish/occluder_detector.h"

namespace diminish {

/// Objects' outlines, in the images that OcclusionMasks has.
struct OcclusionOutlines {
  Polygons color;
  std::vector<Polygons> rgbd_color, rgbd_depth;

  /// Of as many RGB-D cameras, with nothing in it.
  void clear(std::size_t cameras);
};

/// A detector of objects whose shape is known. It outlines them, and whoever draws the masks
/// (MaskDrawer) draws these, too.
class ShapeDetector : public OccluderDetector {
 public:
  /// Adds the object's outlines, as those of `object`, and leaves the others alone. What it covers
  /// is known when it has been drawn: the report's `in_color` and `in_rgbd` are left false.
  virtual OccluderReport outline(const Observation& observation, std::uint32_t object,
                                 OcclusionOutlines& outlines) = 0;

  /// Outlines and draws.
  OccluderReport detect(const Observation& observation, OcclusionMasks& masks) override;

 private:
  OcclusionOutlines outlines_;
  PolygonFiller filler_;
};

}  // namespace diminish
