#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// How far a marker is by an RGB-D camera's depth, beside how far it is by its size.
struct MarkerScale {
  int marker = 0;
  double ratio = 1;  ///< measured / computed depth
};

/// Whether an RGB-D camera's depth, its focal length and the markers' sizes fit one another: each
/// marker of known size that it sees tells its distance twice.
class DepthScale {
 public:
  /// Further from 1, a ratio is wrong: sensors are off by 2 %, a marker's distance by its corners
  /// by 1 % (smaller markers do not count), prints by 1 %.
  static constexpr double tolerance = 0.05;

  DepthScale(const Rig& rig, const Scene& scene);

  /// by_camera: for each RGB-D camera the marker whose ratio is furthest from 1. Nothing where it
  /// sees none, or measures no depth on them. Cost: 30 us a marker.
  void find(const FrameSet& frame, const Markers& markers,
            std::vector<std::optional<MarkerScale>>& by_camera) const;

 private:
  std::optional<MarkerScale> find(const FrameSet& frame, const std::vector<Marker>& seen,
                                  std::size_t camera) const;

  Rig rig_;
  std::map<int, double> sizes_m_;
};

}  // namespace diminish
