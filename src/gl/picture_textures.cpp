#include "gl/picture_textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/rows.h"
#include "gl/pixels_of.h"
#include "gl/program.h"

namespace diminish::gl {
namespace {

static_assert(sizeof(Bgr) == 3);

/// A texture, and when it was written.
struct Slot {
  explicit Slot(const Intrinsics& color) {
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, GL_RGBA8, color.width, color.height);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  ~Slot() {
    glDeleteTextures(1, &texture);
    glDeleteSync(ready);
  }
  Slot(const Slot&) = delete;
  Slot& operator=(const Slot&) = delete;

  GLuint texture = 0;
  GLsync ready = nullptr;
};

}  // namespace

struct PictureTextures::Resources {
  Resources(const Intrinsics& color, int textures)
      : draw_region(compute_program({"draw_region.comp"})) {
    packed.reserve(pixels_of(color.bounds()) * sizeof(Bgr));
    for (int i = 0; i < textures; ++i) slots.push_back(std::make_unique<Slot>(color));
  }

  std::vector<std::unique_ptr<Slot>> slots;
  std::size_t next = 0;  ///< of the slots
  MappedBuffer packed{MappedBuffer::Use::upload};
  Program draw_region;
};

PictureTextures::PictureTextures(const GlSharing& application, const Intrinsics& color)
    : context_(Context::sharing_with(application)), color_(color) {
  if (application.textures < 1) {
    throw Error(fmt::format("textures: expected at least 1, got {}", application.textures));
  }
  context_.run([&] {
    resources_ = std::make_unique<Resources>(color, application.textures);
    // Objects created in one context are there for the others when that is done.
    wait_until_done();
    context_.check("making textures");
  });
}

PictureTextures::~PictureTextures() {
  context_.run([&] { resources_.reset(); });
}

void PictureTextures::upload(ImageView<Bgr> picture) {
  pack(picture);
  context_.run([&] {
    draw_packed();
    wait_until_done();
    context_.check("uploading a picture");
    publish();
  });
}

void PictureTextures::pack(ImageView<Bgr> picture) {
  auto* const to = reinterpret_cast<Bgr*>(resources_->packed.data());
  const std::ptrdiff_t width = picture.width();
  for_rows(picture.height(), [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      std::copy_n(picture.row(y), width, to + y * width);
    }
  });
}

void PictureTextures::draw_packed() const {
  const Resources& r = *resources_;
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, r.packed.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(r.slots[r.next]->texture, 0, 0, 0, color_.width, color_.height, GL_BGR,
                      GL_UNSIGNED_BYTE, nullptr);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

void PictureTextures::draw_region(const Buffer& pixels, const Rect& region) const {
  const Resources& r = *resources_;
  pixels.bind(0);
  // As integers, so that the stored value is the computed one.
  glBindImageTexture(0, r.slots[r.next]->texture, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8UI);
  r.draw_region.use();
  glProgramUniform4i(r.draw_region.name(), 0, region.x, region.y, region.width, region.height);
  glDispatchCompute(static_cast<GLuint>((region.width + 63) / 64),
                    static_cast<GLuint>(region.height), 1);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT |
                  GL_FRAMEBUFFER_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

void PictureTextures::publish() {
  Resources& r = *resources_;
  Slot& slot = *r.slots[r.next];
  r.next = (r.next + 1) % r.slots.size();
  glDeleteSync(slot.ready);
  slot.ready = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  // Another context may wait for it only after it was flushed.
  glFlush();
  latest_ = {slot.texture, color_.width, color_.height, slot.ready};
}

}  // namespace diminish::gl
