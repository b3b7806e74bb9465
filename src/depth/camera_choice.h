#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/occlusion_masks.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "geometry/projection.h"
#include "geometry/ray_table.h"

namespace diminish {

/// Which RGB-D cameras add to what is drawn behind the objects, so that a frame's time grows by
/// what is seen, not by how many cameras are plugged in. A camera is worth, in each tile of the
/// objects' masks that it sees, how much it looks in the user's direction and how fresh its images
/// are. The cameras worth most together are taken one after another, until the next would add
/// little.
class CameraChoice {
 public:
  explicit CameraChoice(const Rig& rig);

  /// Rigs with fewer cameras use all.
  static constexpr std::size_t usual_cameras = 2;
  /// Of all that a camera could be worth: one that adds less is spared.
  static constexpr float least_gain = 0.01F;

  /// objects: the masks' box. Returns which cameras are spared; none that measures no depth or has
  /// no pose. Cost: 0.5 ms for each camera, shared by threads.
  const std::vector<bool>& find_spared(const FrameSet& frame, const Poses& poses,
                                       const OcclusionMasks& masks, const Rect& objects);

 private:
  struct Camera {
    std::shared_ptr<const RayTable> rays;
    float fx = 0;
    float depth_unit_m = 0;
    bool measures_depth = true;
    bool is_used = false;
    std::vector<float> worth;  ///< by tile
  };

  std::size_t tile_at(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles_.width) +
           static_cast<std::size_t>(column);
  }
  void mark_tiles(const Mask& mask, const Rect& objects);
  void look(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks, std::size_t k);

  Projection user_;
  Rect tiles_;                ///< columns and rows of tiles
  std::vector<bool> wanted_;  ///< the tiles that show an object
  std::vector<Camera> cameras_;
  std::vector<float> best_;
  std::vector<bool> spared_;
};

}  // namespace diminish
