#include "gl/buffer.h"

#include <fmt/format.h>

#include <algorithm>

#include "diminish/error.h"

namespace diminish::gl {

namespace {

/// Throws Error if the driver's `limit` is lower than `count`.
void expect_limit(GLenum limit, std::size_t count, const char* things, const char* unit) {
  GLint64 most = 0;
  glGetInteger64v(limit, &most);
  if (count <= static_cast<std::size_t>(most)) return;
  throw Error(
      Error::device,
      fmt::format("gl: expected a driver with {} of {} {}, this one has {}: the images are too "
                  "large for it",
                  things, count, unit, most));
}

}  // namespace

bool Buffer::reserve(std::size_t bytes) {
  if (bytes <= size_) return false;
  expect_limit(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, bytes, "storage blocks", "bytes");
  name_.create();
  glNamedBufferStorage(name_.get(), static_cast<GLsizeiptr>(bytes), nullptr, 0);
  size_ = bytes;
  return true;
}

void BufferTexture::create(const Buffer& buffer, GLenum format, std::size_t texels) {
  expect_limit(GL_MAX_TEXTURE_BUFFER_SIZE, texels, "buffer textures", "texels");
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
  if (!data_)
    throw Error(Error::device, "gl: memory for the transfer of images could not be mapped");
}

void wait_until_done() {
  constexpr GLuint64 longest_ns = 10'000'000'000;
  const GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  const GLenum state = glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, longest_ns);
  glDeleteSync(fence);
  if (state != GL_ALREADY_SIGNALED && state != GL_CONDITION_SATISFIED) {
    throw Error(Error::device, "gl: the driver did not finish a frame within 10 s");
  }
}

}  // namespace diminish::gl
