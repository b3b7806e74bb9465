#pragma once

#include <cstddef>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// A marker that the colour camera sees elsewhere than where an RGB-D camera locates it.
struct MarkerShift {
  int marker = 0;
  double shift = 0;  ///< of its centre, radians
};

/// Whether the colour camera sees the markers where the RGB-D cameras locate them: objects' masks
/// are drawn there.
class MarkerAgreement {
 public:
  /// Radians: twice what one marker leaves open of a pose, which then is refined.
  static constexpr double tolerance = std::numbers::pi / 180;

  MarkerAgreement(const Rig& rig, const Scene& scene);

  /// poses: refined. by_camera: for each RGB-D camera the marker that is shifted most. Nothing
  /// where it and the colour camera see none of the same. Cost: 30 us a marker.
  void find(const FrameSet& frame, const Markers& markers, const Poses& poses,
            std::vector<std::optional<MarkerShift>>& by_camera) const;

 private:
  Rig rig_;
  Lens color_lens_;
  std::vector<Lens> sensor_lenses_;  ///< of each RGB-D camera's colours
  std::map<int, double> sizes_m_;
};

}  // namespace diminish
