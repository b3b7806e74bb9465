#pragma once

#include "diminish/export.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// Throws Error that names the key as in rig.yaml and what was expected: "color.width: expected a
/// whole number from 8 to 16384, got '0'". Files are checked in the same way when read, with file
/// and line in front. Pipeline checks its arguments too.
DIMINISH_EXPORT void validate(const Rig& rig);
/// The same for a scene.
DIMINISH_EXPORT void validate(const Scene& scene);
/// The same, and that the scene fits the rig.
DIMINISH_EXPORT void validate(const Scene& scene, const Rig& rig);

}  // namespace diminish
