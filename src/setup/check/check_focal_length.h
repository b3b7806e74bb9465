#pragma once

#include <optional>
#include <string>

#include "setup/check/diagnosis.h"

namespace diminish {

/// The least gain in the pictures' correlation for blaming a focal length.
inline constexpr double least_improvement = 0.04;

/// The rig with a colour sensor's focal length times a factor. sensor: as in `color_sensor`.
Rig with_focal_length(Rig rig, std::size_t sensor, double factor);

/// How well the pictures in the kept frames agree with this set-up (correlation).
std::optional<double> agreement(const Diagnosis& setup, const Rig& rig, const Scene& scene);

/// figure: the evidence.
void blame_focal_length(Diagnosis& setup, std::size_t sensor, double factor,
                        const std::string& figure);

}  // namespace diminish
