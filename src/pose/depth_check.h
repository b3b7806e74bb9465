#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "core/robust.h"
#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// The depth at a place on a marker: measured, and according to its pose.
struct MarkerDepth {
  double measured_m, computed_m;
};

/// The depth of a place, given in the depth sensor's frame; nothing outside the image, or where
/// none was measured.
std::optional<MarkerDepth> depth_at(const Eigen::Vector3d& x_in_depth, const Lens& depth_lens,
                                    ImageView<std::uint16_t> depth, double depth_unit_m);

/// Depths over a grid of places on a marker.
struct MarkerDepths {
  static constexpr std::size_t most = 81;  ///< 9 places along each side

  std::array<MarkerDepth, most> values;
  std::size_t count = 0;

  auto begin() const { return values.begin(); }
  auto end() const { return values.begin() + static_cast<std::ptrdiff_t>(count); }
};

/// None if fewer than half of them were measured.
MarkerDepths marker_depths(const RigidTransform& depth_from_marker, double size_m,
                           const Lens& depth_lens, ImageView<std::uint16_t> depth,
                           double depth_unit_m);
/// The median over a marker of a function of its depths; nothing if there are none.
template <class Function>
std::optional<double> median_over_marker(const MarkerDepths& depths, const Function& function) {
  if (depths.count == 0) return std::nullopt;
  std::array<double, MarkerDepths::most> values{};
  const auto end = std::transform(depths.begin(), depths.end(), values.begin(), function);
  return median(values.begin(), end);
}

/// The distance of the measured depth from a marker's plane: the median over `marker_depths`,
/// metres. Nothing if there are none.
std::optional<double> marker_depth_error_m(const RigidTransform& depth_from_marker, double size_m,
                                           const Lens& depth_lens, ImageView<std::uint16_t> depth,
                                           double depth_unit_m);

}  // namespace diminish
