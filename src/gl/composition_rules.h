#pragma once

#include <string>

namespace diminish::gl {

/// The constants that the processor's stages have, for composition.glsl and the passes after it, as
/// lines of definitions.
std::string composition_rules();

}  // namespace diminish::gl
