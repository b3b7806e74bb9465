#include "pipeline/frame_texture.h"

#include "diminish/error.h"
#ifdef DIMINISH_HAS_GL
#include "gl/picture_textures.h"
#endif

namespace diminish {

std::unique_ptr<TextureOutput> make_texture_output([[maybe_unused]] const GlSharing& application,
                                                   [[maybe_unused]] const Intrinsics& color) {
#ifdef DIMINISH_HAS_GL
  return std::make_unique<gl::PictureTextures>(application, color);
#else
  throw Error("textures: this build of diminish has no OpenGL (DIMINISH_WITH_GL)");
#endif
}

void FrameTexture::finish_frame(bool drawn, DiminishedFrame& result) {
  if (!output_) return;
  std::vector<std::string>& messages = result.report.messages;
  if (!drawn) {
    try {
      output_->upload(result.picture);
    } catch (const Error& error) {
      messages.push_back(std::string(error.what()) + "; the picture is no texture");
      return;
    }
    messages.emplace_back("the picture was made by the CPU, and uploaded to its texture");
  }
  texture_ = output_->latest();
}

}  // namespace diminish
