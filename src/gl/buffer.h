#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <utility>

namespace diminish::gl {

/// A buffer's name. Deletes the buffer at its end, when the context must be current.
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

/// A buffer in the GPU's own memory.
class Buffer {
 public:
  /// Makes it at least this large. Its contents are lost if it grows. Returns whether it grew.
  /// Throws Error if it exceeds the driver's limit for storage blocks.
  bool reserve(std::size_t bytes);
  /// Binds it for shaders as storage block `binding`.
  void bind(GLuint binding) const {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, name_.get());
  }
  GLuint name() const { return name_.get(); }

 private:
  BufferName name_;
  std::size_t size_ = 0;
};

/// A buffer as a texture of `format`: best for shaders that only read it.
class BufferTexture {
 public:
  BufferTexture() = default;
  ~BufferTexture() {
    if (name_ != 0) glDeleteTextures(1, &name_);
  }
  BufferTexture(const BufferTexture&) = delete;
  BufferTexture& operator=(const BufferTexture&) = delete;

  /// Takes the buffer as it is now; create it again when the buffer grows. Throws Error if it has
  /// more texels than the driver allows.
  void create(const Buffer& buffer, GLenum format, std::size_t texels);
  void bind(GLuint unit) const { glBindTextureUnit(unit, name_); }

 private:
  GLuint name_ = 0;
};

/// Memory that both the CPU and the GPU can access, mapped for as long as it lives. Uploads and
/// downloads pass through it.
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

/// Copies `bytes` from the start of one buffer to another, at byte `at`.
inline void copy(GLuint from, GLuint to, std::size_t bytes, std::size_t at = 0) {
  glCopyNamedBufferSubData(from, to, 0, static_cast<GLintptr>(at), static_cast<GLsizeiptr>(bytes));
}

/// Waits until all commands so far are done. Throws Error after ten seconds.
void wait_until_done();

}  // namespace diminish::gl
