#pragma once

#include <Eigen/Core>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "geometry/depth_view.h"

namespace diminish {

/// Where RGB-D cameras see that there is nothing: in front of what they measure.
class FreeSpace {
 public:
  explicit FreeSpace(const Rig& rig);

  /// The frame must outlive what is asked.
  void begin(const FrameSet& frame, const Poses& poses);

  /// Whether nothing can be between two depths on a line of sight of the colour camera, away from
  /// its ends. ray: (x, y, 1), in the colour camera's frame. Cost: about 0.1 us.
  bool is_free(const Eigen::Vector2f& ray, float from_m, float to_m) const;

 private:
  std::vector<DepthView> cameras_;
};

}  // namespace diminish
