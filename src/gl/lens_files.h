#pragma once

#include <string>
#include <vector>

#include "diminish/rig.h"

namespace diminish::gl {

/// The shader files that say how the lenses of a rig's colour sensors distort; after frame.glsl.
std::vector<std::string> lens_files(const Rig& rig);

}  // namespace diminish::gl
