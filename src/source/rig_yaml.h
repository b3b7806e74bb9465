#pragma once

#include <string>

#include "diminish/rig.h"

namespace diminish {

// What rig.yaml holds, as one line of YAML each.

std::string as_yaml(const Intrinsics& camera);
std::string as_yaml(const RigidTransform& transform);

/// A whole rig.yaml. pose: its key `pose`.
std::string as_yaml(const Rig& rig, const std::string& pose);

}  // namespace diminish
