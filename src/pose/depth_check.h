#pragma once

#include <optional>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// The depth at a place on a marker: measured, and according to its pose.
struct MarkerDepth {
  double measured_m, computed_m;
};

/// Depths over a grid of places on the marker. Empty if fewer than half of them were measured.
std::vector<MarkerDepth> marker_depths(const RigidTransform& depth_from_marker, double size_m,
                                       const Lens& depth_lens, ImageView<std::uint16_t> depth,
                                       double depth_unit_m);

/// The distance of the measured depth from a marker's plane: the median over `marker_depths`,
/// metres. Nothing if there are none.
std::optional<double> marker_depth_error_m(const RigidTransform& depth_from_marker, double size_m,
                                           const Lens& depth_lens, ImageView<std::uint16_t> depth,
                                           double depth_unit_m);

}  // namespace diminish
