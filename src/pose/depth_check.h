#pragma once

#include <optional>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// How far the measured depth is from a marker's plane: the median over a grid of places on the
/// marker, metres. Nothing when fewer than half of them were measured.
std::optional<double> marker_depth_error_m(const RigidTransform& depth_from_marker, double size_m,
                                           const Lens& depth_lens,
                                           const Image<std::uint16_t>& depth, double depth_unit_m);

}  // namespace diminish
