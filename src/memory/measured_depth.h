#pragma once

#include <memory>
#include <vector>

#include "core/rows.h"
#include "diminish/frame_set.h"
#include "diminish/occlusion_masks.h"
#include "diminish/options.h"
#include "diminish/poses.h"
#include "memory/keyframe.h"

namespace diminish {

/// What the RGB-D cameras measure, at the places of KeyframeGrid. Points are enough: the grid is
/// about as coarse as they are, and what stays open between them is completed anyway. A place has
/// the mean of the nearest surface's points, so that depth images need no smoothing.
class MeasuredDepth {
 public:
  MeasuredDepth(const Rig& rig, const KeyframeGrid& grid);

  /// depth_m: in the user's view; 0: nothing was measured, or it is an object to remove. Cost: 15
  /// ns a depth pixel that is used: of those that are much finer than the grid, only some are.
  void draw(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
            const Options& options, Image<float>& depth_m);

 private:
  struct Camera {
    int step;         ///< between pixels that are used
    float unit_m;     ///< of depth
    float magnified;  ///< places along the distance of two such pixels, at the same depth
    std::shared_ptr<const RayTable> rays;
    // Of the pixels that are used.
    Image<float> own_m;         ///< in the depth sensor's view
    Image<float> z_m;           ///< in the user's
    Image<std::int32_t> place;  ///< of the grid; -1: none
    std::vector<std::uint16_t> rows[most_bands];
  };
  void find_places(const RgbdFrame& images, const RigidTransform& color_from_depth,
                   const Mask& mask, bool remove_flying, Camera& camera) const;
  template <class Visit>
  void for_each_point(const Camera& camera, const Visit& visit) const;

  KeyframeGrid grid_;
  std::vector<Camera> cameras_;
  /// The nearest surface's points at a place.
  struct Place {
    float nearest_m, sum_m, count;
  };
  Image<Place> places_;
  Image<float> mean_m_;
};

}  // namespace diminish
