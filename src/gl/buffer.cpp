#include "gl/buffer.h"

#include <fmt/format.h>

#include <algorithm>

#include "diminish/error.h"

namespace diminish::gl {

bool Buffer::reserve(std::size_t bytes) {
  if (bytes <= size_) return false;
  GLint64 most = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  if (bytes > static_cast<std::size_t>(most)) {
    throw Error(
        fmt::format("gl: expected a driver with storage blocks of {} bytes, this one has {}: "
                    "the images are too large for it",
                    bytes, most));
  }
  name_.create();
  glNamedBufferStorage(name_.get(), static_cast<GLsizeiptr>(bytes), nullptr, 0);
  size_ = bytes;
  return true;
}

void BufferTexture::create(const Buffer& buffer, GLenum format, std::size_t texels) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  if (texels > static_cast<std::size_t>(most)) {
    throw Error(
        fmt::format("gl: expected a driver with buffer textures of {} texels, this one has "
                    "{}: the RGB-D cameras' images are too large for it",
                    texels, most));
  }
  if (name_ != 0) glDeleteTextures(1, &name_);
  glCreateTextures(GL_TEXTURE_BUFFER, 1, &name_);
  glTextureBuffer(name_, format, buffer.name());
}

void MappedBuffer::reserve(std::size_t bytes) {
  if (bytes <= size_) return;
  const GLbitfield access = GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT |
                            (use_ == Use::upload ? GL_MAP_WRITE_BIT : GL_MAP_READ_BIT);
  name_.create();
  glNamedBufferStorage(name_.get(), static_cast<GLsizeiptr>(bytes), nullptr,
                       access | (use_ == Use::download ? GL_CLIENT_STORAGE_BIT : 0U));
  data_ = static_cast<std::byte*>(
      glMapNamedBufferRange(name_.get(), 0, static_cast<GLsizeiptr>(bytes), access));
  size_ = data_ ? bytes : 0;
  if (!data_) throw Error("gl: memory for the transfer of images could not be mapped");
}

void wait_until_done() {
  constexpr GLuint64 longest_ns = 10'000'000'000;
  const GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  const GLenum state = glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, longest_ns);
  glDeleteSync(fence);
  if (state != GL_ALREADY_SIGNALED && state != GL_CONDITION_SATISFIED) {
    throw Error("gl: the driver did not finish a frame within 10 s");
  }
}

}  // namespace diminish::gl
