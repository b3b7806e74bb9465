#pragma once

#include <memory>
#include <vector>

#include "detect/difference/object_evidence.h"
#include "detect/difference/seen_layers.h"
#include "diminish/image.h"
#include "diminish/rigid_transform.h"
#include "geometry/projection.h"
#include "geometry/ray_table.h"

namespace diminish {

/// What the frames before say about a frame's objects. The surface that a pixel shows is looked up
/// in each of them, by the colour camera's poses. If it looks as it does now, and most of them took
/// it for the scene, it still is. Where it looks different something has come, and only this frame
/// counts.
class EvidenceHistory {
 public:
  /// color: the user's camera. shrinkage: of the small picture.
  EvidenceHistory(const Intrinsics& color, int shrinkage);

  struct Inputs {
    const Image<Bgr>& picture;
    const SeenLayers& layers;
    const ObjectEvidence& evidence;
    const RigidTransform& color_from_world;
    double stamp_s;
  };
  /// Makes objects the scene where the frames before outvote this one, and keeps this frame's own
  /// evidence for those to come. Frames come in their order. part: where objects may be. Cost:
  /// about 0.1 us for each pixel of an object.
  void steady(const Inputs& inputs, const Rect& part, Image<Shown>& shown);

 private:
  struct Moment {
    double stamp_s = 0;
    RigidTransform color_from_world;
    FloatTransform from_now{RigidTransform{}};
    Image<Bgr> picture;
    Image<Shown> shown;
  };
  void begin(const Inputs& inputs, const Image<Shown>& shown);
  bool was_scene(const Inputs& inputs, int x, int y) const;
  /// What a point of the colour camera's frame was taken for then; unknown if it looked different.
  Shown recall(const Moment& then, const Eigen::Vector3f& point_m, const Inputs& inputs, int x,
               int y) const;

  std::vector<Moment> moments_;  ///< the newest first; the last one's memory is free
  std::size_t known_ = 0;        ///< how many of them count
  Projection projection_;        ///< of the small picture, as is the next
  std::shared_ptr<const RayTable> rays_;
};

}  // namespace diminish
