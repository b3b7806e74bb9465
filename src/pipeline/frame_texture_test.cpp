#include "pipeline/frame_texture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "expect_error.h"

namespace diminish {
namespace {

/// Counts pictures, and fails at the second.
class Counting : public TextureOutput {
 public:
  void upload(ImageView<Bgr> picture) override {
    if (latest_.name == 1) throw Error("the driver lost the context");
    latest_ = {latest_.name + 1, picture.width(), picture.height(), nullptr};
  }
  const GlTexture& latest() const override { return latest_; }

 private:
  GlTexture latest_;
};

TEST(FrameTexture, IsNotThereWhereTheGpuFails) {
  FrameTexture texture;
  DiminishedFrame result;
  result.picture.resize(3, 2);
  texture.finish_frame(false, result);
  EXPECT_EQ(texture.output(), nullptr);
  EXPECT_TRUE(result.report.messages.empty());

  texture.put_to(std::make_unique<Counting>());
  texture.begin_frame();
  texture.finish_frame(false, result);
  EXPECT_EQ(texture.texture().name, 1U);
  EXPECT_EQ(texture.texture().width, 3);
  EXPECT_EQ(result.report.messages.size(), 1U);

  texture.begin_frame();
  texture.finish_frame(true, result);
  EXPECT_EQ(texture.texture().name, 1U);
  EXPECT_EQ(result.report.messages.size(), 1U);

  texture.begin_frame();
  texture.finish_frame(false, result);
  EXPECT_EQ(texture.texture().name, 0U);
  EXPECT_EQ(result.report.messages.back(),
            "the driver lost the context; the picture is no texture");
  EXPECT_FALSE(result.picture.empty());
}

#ifndef DIMINISH_HAS_GL
TEST(FrameTexture, NeedsABuildWithOpenGl) {
  EXPECT_THAT(error_of([] { make_texture_output({}, {}); }), ::testing::HasSubstr("no OpenGL"));
}
#endif

}  // namespace
}  // namespace diminish
