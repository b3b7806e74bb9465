#pragma once

#include <epoxy/gl.h>

#include <string>
#include <utility>
#include <vector>

namespace diminish::gl {

/// One stage of a program: files of src/gl/shaders, concatenated.
struct Shader {
  GLenum stage;
  std::vector<std::string> files;
  std::string defines;  ///< lines before them
};

/// A linked program. Create and delete it while the context is current.
class Program {
 public:
  /// Throws Error with file and line of what the driver's compiler rejected.
  explicit Program(const std::vector<Shader>& shaders);
  ~Program() { glDeleteProgram(name_); }
  Program(Program&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Program& operator=(Program&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }

  void use() const { glUseProgram(name_); }
  GLuint name() const { return name_; }
  /// -1 if the compiler removed the uniform; setting that is no error.
  GLint location(const char* uniform) const { return glGetUniformLocation(name_, uniform); }
  void set(const char* uniform, int value) const {
    glProgramUniform1i(name_, location(uniform), value);
  }
  void set(const char* uniform, float value) const {
    glProgramUniform1f(name_, location(uniform), value);
  }

 private:
  GLuint name_ = 0;
};

/// A program of one compute shader.
inline Program compute_program(std::vector<std::string> files, std::string defines = {}) {
  return Program({{GL_COMPUTE_SHADER, std::move(files), std::move(defines)}});
}

/// Whether src/gl/shaders has a file of this name.
bool has_shader_file(const std::string& name);

/// The beginning of every shader: the version and constants of the CPU's code.
std::string shader_prologue();

}  // namespace diminish::gl
