#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "depth/depth_noise.h"
#include "diminish/image.h"

namespace diminish::gl {

// A constant of the CPU's code as a line to compile shaders with: they have no numbers of their
// own.

inline std::string define_as(const char* name, const std::string& value) {
  return fmt::format("#define {} {}\n", name, value);
}
inline std::string define(const char* name, int value) {
  return define_as(name, fmt::format("{}", value));
}
inline std::string define(const char* name, std::size_t value) {
  return define(name, static_cast<int>(value));
}
inline std::string define(const char* name, std::uint8_t value) {
  return define_as(name, fmt::format("{}u", value));
}
inline std::string define(const char* name, float value) {
  return define_as(name, fmt::format("{:.9e}", value));
}
inline std::string define(const char* name, const float (&values)[3]) {
  return define_as(
      name, fmt::format("float[3]({:.9e}, {:.9e}, {:.9e})", values[0], values[1], values[2]));
}
inline std::string define(const char* name, const DepthNoise& noise) {
  return define_as(name, fmt::format("vec2({:.9e}, {:.9e})", noise.constant_m, noise.by_square));
}
inline std::string define(const char* name, const Bgr& color) {
  return define_as(name, fmt::format("vec3({}, {}, {})", color.b, color.g, color.r));
}

}  // namespace diminish::gl
