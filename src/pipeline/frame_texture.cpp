#include "pipeline/frame_texture.h"

#include "diminish/error.h"
#ifdef DIMINISH_HAS_GL
#include "gl/picture_textures.h"
#endif

namespace diminish {

void FrameTexture::want(const std::optional<GlSharing>& application,
                        [[maybe_unused]] const Intrinsics& color) {
  texture_ = {};
  output_.reset();
  if (!application) return;
#ifdef DIMINISH_HAS_GL
  output_ = std::make_unique<gl::PictureTextures>(*application, color);
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
    messages.push_back("the picture was made by the processor, and uploaded to its texture");
  }
  texture_ = output_->latest();
}

}  // namespace diminish
