#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <utility>

namespace diminish::gl {

/// A buffer's name; deleted with it, which must happen while the context is current.
class BufferName {
 public:
  BufferName() = default;
  ~BufferName() { reset(); }
  BufferName(BufferName&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  BufferName& operator=(BufferName&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }

  void create() {
    reset();
    glCreateBuffers(1, &name_);
  }
  GLuint get() const { return name_; }

 private:
  void reset() {
    if (name_ != 0) glDeleteBuffers(1, &name_);
    name_ = 0;
  }

  GLuint name_ = 0;
};

/// Memory of the GPU's own.
class Buffer {
 public:
  /// Makes it this large at least; what it held is lost if it grows. Returns whether it grew.
  /// Throws Error where it is larger than what the driver's storage blocks may be.
  bool reserve(std::size_t bytes);
  /// For shaders, as storage block `binding`.
  void bind(GLuint binding) const {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, name_.get());
  }
  GLuint name() const { return name_.get(); }

 private:
  BufferName name_;
  std::size_t size_ = 0;
};

/// A buffer as a texture of `format`: what shaders that only read it do best.
class BufferTexture {
 public:
  BufferTexture() = default;
  ~BufferTexture() {
    if (name_ != 0) glDeleteTextures(1, &name_);
  }
  BufferTexture(const BufferTexture&) = delete;
  BufferTexture& operator=(const BufferTexture&) = delete;

  /// The buffer as it is now: made anew when it grows. Throws Error where it has more texels
  /// than the driver takes.
  void create(const Buffer& buffer, GLenum format, std::size_t texels);
  void bind(GLuint unit) const { glBindTextureUnit(unit, name_); }

 private:
  GLuint name_ = 0;
};

/// Memory that the processor and the GPU both reach, mapped for as long as it lives: what is
/// uploaded and downloaded passes through it.
class MappedBuffer {
 public:
  enum class Use { upload, download };
  explicit MappedBuffer(Use use) : use_(use) {}

  void reserve(std::size_t bytes);
  std::byte* data() const { return data_; }
  GLuint name() const { return name_.get(); }

 private:
  Use use_;
  BufferName name_;
  std::size_t size_ = 0;
  std::byte* data_ = nullptr;
};

/// Copies `bytes` from the start of one buffer to another, from its byte `at` on.
inline void copy(GLuint from, GLuint to, std::size_t bytes, std::size_t at = 0) {
  glCopyNamedBufferSubData(from, to, 0, static_cast<GLintptr>(at), static_cast<GLsizeiptr>(bytes));
}

/// Waits until everything that was asked for so far is done. Throws Error after ten seconds.
void wait_until_done();

}  // namespace diminish::gl
