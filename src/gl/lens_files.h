#pragma once

#include <string>
#include <vector>

#include "diminish/rig.h"

namespace diminish::gl {

/// The shader files that say how the lenses of a rig's colour sensors distort; after frame.glsl.
std::vector<std::string> lens_files(const Rig& rig);

/// The shader files of a program that finds the mesh's vertices, whose main file is `last`.
std::vector<std::string> vertex_files(const Rig& rig, const char* last);

}  // namespace diminish::gl
