#pragma once

#include "diminish/config.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// Reads `{rotation: [9 numbers, row-major], translation: [3 numbers]}`. Replaces the rotation by
/// the nearest exact one. Throws Error that names file and key if it is off by more than 0.001.
RigidTransform read_rigid_transform(const Config& config);

}  // namespace diminish
