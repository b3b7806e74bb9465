#include "gl/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "diminish/error.h"
#include "diminish/tiled_region.h"
#include "geometry/distortion.h"
#include "render/color_ray.h"
#include "render/sdct.h"
#include "shader_files.h"

namespace diminish::gl {
namespace {

/// The lines of file number i are numbered from i * `file_lines` on: drivers write "0:12(5): error:
/// ..." or "0(12) : error ...", and not all of them use #line's second number.
constexpr std::size_t file_lines = 10000;

/// The first error in a compiler's log, with the names of the files.
std::string first_error(std::string_view log, const std::vector<std::string>& files) {
  const std::size_t error = std::min(log.find("error"), log.size());
  const std::size_t before = error == 0 ? std::string_view::npos : log.rfind('\n', error - 1);
  log.remove_prefix(before == std::string_view::npos || error == log.size() ? 0 : before + 1);
  const std::string_view line = log.substr(0, log.find('\n'));
  constexpr std::string_view digits = "0123456789";
  const std::size_t separator = line.find_first_not_of(digits);
  const std::size_t start = std::min(line.find_first_of(digits, separator), line.size());
  std::size_t number = 0;
  const auto [end, problem] =
      std::from_chars(line.data() + start, line.data() + line.size(), number);
  const std::size_t file = number / file_lines;
  if (problem != std::errc() || file < 1 || file > files.size()) {
    return fmt::format("{}: {}", files.back(), line);
  }
  const auto rest = line.substr(static_cast<std::size_t>(end - line.data()));
  return fmt::format("{}:{}{}", files[file - 1], number % file_lines, rest);
}

std::string_view shader_file(const std::string& name) {
  const auto found = shader_files().find(name);
  if (found == shader_files().end())
    throw Error(Error::internal, "gl: there is no shader file '" + name + "'");
  return found->second;
}

template <class Get, class Log>
std::string log_of(GLuint object, const Get& get, const Log& get_log) {
  GLint length = 0;
  get(object, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(length > 0 ? length : 1), '\0');
  get_log(object, static_cast<GLsizei>(log.size()), nullptr, log.data());
  log.resize(std::min(log.size(), log.find('\0')));  // the driver's text ends there
  return log;
}

/// A shader object; deleted after its program has been linked.
class ShaderObject {
 public:
  explicit ShaderObject(const Shader& shader) : name_(glCreateShader(shader.stage)) {
    std::string text = shader_prologue() + shader.defines;
    for (std::size_t i = 0; i < shader.files.size(); ++i) {
      text += fmt::format("#line {}\n", (i + 1) * file_lines + 1);
      text += shader_file(shader.files[i]);
    }
    const char* const start = text.c_str();
    glShaderSource(name_, 1, &start, nullptr);
    glCompileShader(name_);
    GLint compiled = GL_FALSE;
    glGetShaderiv(name_, GL_COMPILE_STATUS, &compiled);
    if (compiled == GL_TRUE) return;
    const std::string log = log_of(name_, glGetShaderiv, glGetShaderInfoLog);
    glDeleteShader(name_);
    throw Error(Error::internal, "gl: shader " + first_error(log, shader.files));
  }
  ~ShaderObject() { glDeleteShader(name_); }
  ShaderObject(const ShaderObject&) = delete;
  ShaderObject& operator=(const ShaderObject&) = delete;

  GLuint name() const { return name_; }

 private:
  GLuint name_;
};

}  // namespace

bool has_shader_file(const std::string& name) {
  return shader_files().count(name) != 0;
}

std::string shader_prologue() {
  return fmt::format(
      "#version 450 core\n"
      "#define SUBPIXEL_BITS {}\n"
      "#define MAX_COORDINATE_PX {:.1f}\n"
      "#define NEAR_PLANE_M {:.9g}\n"
      "#define COLOR_RAY_SHIFT {:.9g}\n"
      "#define TILE_PX {}\n"
      "#define RATIONAL {}u\n"
      "#define FISHEYE {}u\n"
      "#define ANGLE_TERMS vec4({:.9g}, {:.9g}, {:.9g}, {:.9g})\n",
      sdct::subpixel_bits, sdct::max_coordinate_px, sdct::near_plane_m, color_ray_shift,
      TiledRegion::tile, static_cast<int>(LensModel::rational),
      static_cast<int>(LensModel::fisheye), distortion::angle_terms[0], distortion::angle_terms[1],
      distortion::angle_terms[2], distortion::angle_terms[3]);
}

Program::Program(const std::vector<Shader>& shaders) : name_(glCreateProgram()) {
  try {
    for (const Shader& shader : shaders) {
      const ShaderObject object(shader);
      glAttachShader(name_, object.name());
    }
    glLinkProgram(name_);
    GLint linked = GL_FALSE;
    glGetProgramiv(name_, GL_LINK_STATUS, &linked);
    if (linked != GL_TRUE) {
      const std::string log = log_of(name_, glGetProgramiv, glGetProgramInfoLog);
      throw Error(Error::internal, fmt::format("gl: program of {}: {}", shaders.back().files.back(),
                                               log.substr(0, log.find('\n'))));
    }
  } catch (...) {
    glDeleteProgram(name_);
    throw;
  }
}

}  // namespace diminish::gl
