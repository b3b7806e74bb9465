#pragma once

#include <string>

namespace diminish::gl {

/// The constants of the CPU's stages as lines of definitions, for composition.glsl and the passes
/// after it.
std::string composition_rules();

}  // namespace diminish::gl
