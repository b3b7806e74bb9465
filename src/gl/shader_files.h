#pragma once

#include <string_view>

namespace diminish::gl {

/// The text of a file of src/gl/shaders, as it was when the library was built.
/// Throws Error if there is no such file.
std::string_view shader_file(std::string_view name);

}  // namespace diminish::gl
