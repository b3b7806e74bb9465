#pragma once

#include "diminish/config.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// Reads `{rotation: [9 numbers, row-major], translation: [3 numbers]}`. The rotation is brought to
/// the nearest exact one. Throws Error, naming file and key, if it is none to within 0.001.
RigidTransform read_rigid_transform(const Config& config);

}  // namespace diminish
