#pragma once

#include <optional>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/poses.h"
#include "diminish/rig.h"

namespace diminish {

/// The ratio of the depth measured on a marker to the depth computed from its size and its picture.
struct DepthRatio {
  double ratio = 1;   ///< measured / computed: median over the marker
  double spread = 0;  ///< median absolute difference from that, relative
};

/// marker: in the RGB-D camera's colour image. Nothing if less than half of the marker was
/// measured.
std::optional<DepthRatio> measure_depth_ratio(const Marker& marker, double size_m,
                                              const RgbdCamera& camera,
                                              ImageView<std::uint16_t> depth);

}  // namespace diminish
