#include "gl/picture_textures.h"

#include <epoxy/egl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "expect_error.h"
#include "first_frame.h"
#include "gpu_options.h"
#include "paths.h"

namespace diminish {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

/// What an application has: an OpenGL context of its own.
class Application {
 public:
  Application() {
    eglInitialize(display, nullptr, nullptr);
    eglBindAPI(EGL_OPENGL_API);
    constexpr EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5,
                                     EGL_NONE};
    context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  }
  ~Application() { eglDestroyContext(display, context); }
  Application(const Application&) = delete;
  Application& operator=(const Application&) = delete;

  GlSharing sharing(int textures = 3) const { return {display, context, textures}; }
  void begin() const { eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context); }
  void end() const { eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }

  /// The texture's pixels, which must be opaque; between `begin` and `end`.
  static Image<Bgr> read(const GlTexture& texture) {
    glWaitSync(static_cast<GLsync>(texture.ready), 0, GL_TIMEOUT_IGNORED);
    glBindTexture(GL_TEXTURE_2D, texture.name);
    Image<Bgra> rgba(texture.width, texture.height);
    glGetTextureImage(texture.name, 0, GL_BGRA, GL_UNSIGNED_BYTE,
                      static_cast<GLsizei>(rgba.size() * sizeof(Bgra)), rgba.data());
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    Image<Bgr> picture(texture.width, texture.height);
    bool is_opaque = true;
    for (std::size_t i = 0; i < rgba.size(); ++i) {
      const Bgra& pixel = rgba.data()[i];
      picture.data()[i] = {pixel.b, pixel.g, pixel.r};
      is_opaque = is_opaque && pixel.a == 255;
    }
    EXPECT_TRUE(is_opaque);
    return picture;
  }
  Image<Bgr> shown(const GlTexture& texture) const {
    begin();
    Image<Bgr> picture = read(texture);
    end();
    return picture;
  }

  EGLDisplay display =
      eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  EGLContext context = EGL_NO_CONTEXT;
};

constexpr const char* by_cpu = "the picture was made by the CPU, and uploaded to its texture";

Options on_gpu() {
  Options options = testing::gpu_options();
  options.backend = "gl";
  return options;
}

class PictureTextures : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Recordings, PictureTextures,
                         ::testing::Values("calendar", "ball", "workbench"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(PictureTextures, HoldWhatElseIsDownloaded) {
  const Application application;
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / GetParam());
  Pipeline downloading(recording.rig, recording.scene, on_gpu());
  Pipeline drawing(recording.rig, recording.scene, on_gpu());
  drawing.want_texture(application.sharing());
  drawing.want_reconstruction(false);
  const auto source = open_recording(recording, {});
  FrameSet frame;
  DiminishedFrame expected;
  DiminishedFrame result;
  for (int i = 0; i < 3 && source->next(frame); ++i) {
    downloading.process(frame, expected);
    drawing.process(frame, result);
    EXPECT_EQ(application.shown(drawing.texture()), expected.picture) << frame.name;
    EXPECT_NE(frame.color.own(), expected.picture) << frame.name;
    EXPECT_TRUE(result.picture.empty());
    EXPECT_TRUE(result.provenance.empty());
    EXPECT_EQ(result.mask, expected.mask);
    EXPECT_EQ(result.report.mask_pixels, expected.report.mask_pixels);
    EXPECT_EQ(result.report.valid_pixels, expected.report.valid_pixels);
    EXPECT_EQ(result.report.missing_pixels, expected.report.missing_pixels);
    EXPECT_EQ(result.report.messages, expected.report.messages);
  }
}

/// The calendar's first frame, with textures for an application.
class Textures : public ::testing::Test {
 protected:
  Textures() : scene("calendar"), pipeline(scene.recording.rig, scene.recording.scene, on_gpu()) {
    pipeline.want_texture(application.sharing());
  }

  Application application;
  testing::FirstFrame scene;
  Pipeline pipeline;
  DiminishedFrame result;
};

TEST_F(Textures, AreLeftAloneUntilTheirTurnComesAgain) {
  const auto source = open_recording(scene.recording, {});
  std::vector<GlTexture> textures;
  std::vector<Image<Bgr>> pictures;
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(source->next(scene.frame));
    pipeline.process(scene.frame, result);
    textures.push_back(pipeline.texture());
    pictures.push_back(application.shown(textures.back()));
    if (i == 2) {
      EXPECT_EQ(application.shown(textures[0]), pictures[0]);
      EXPECT_EQ(application.shown(textures[1]), pictures[1]);
    }
  }
  EXPECT_NE(pictures[0], pictures[1]);
  EXPECT_NE(textures[0].name, textures[1].name);
  EXPECT_NE(textures[1].name, textures[2].name);
  EXPECT_EQ(textures[3].name, textures[0].name);
  EXPECT_NE(pictures[3], pictures[0]);
}

TEST_F(Textures, MayBeLookedAtByAnotherThreadWhoseContextStaysCurrent) {
  std::atomic<int> made = 0;
  std::atomic<int> shown = -1;
  Image<Bgr> picture;
  std::thread window([&] {
    application.begin();
    shown = 0;
    for (int i = 1; i <= 2; ++i) {
      while (made < i) std::this_thread::yield();
      picture = Application::read(pipeline.texture());
      shown = i;
    }
    application.end();
  });
  while (shown < 0) std::this_thread::yield();
  Pipeline downloading(scene.recording.rig, scene.recording.scene, on_gpu());
  pipeline.want_texture(application.sharing(1));
  for (int i = 1; i <= 2; ++i) {
    pipeline.process(scene.frame, result);
    made = i;
    while (shown < i) std::this_thread::yield();
    downloading.process(scene.frame, result);
    EXPECT_EQ(picture, result.picture);
  }
  window.join();
}

TEST_F(Textures, LeaveTheApplicationsContextCurrent) {
  application.begin();
  pipeline.process(scene.frame, result);
  EXPECT_EQ(eglGetCurrentContext(), application.context);
  EXPECT_FALSE(Application::read(pipeline.texture()).empty());
  application.end();
}

// From a backend of the CPU's, a GPU's that leaves the rest to it, or one that fails.
TEST_F(Textures, HoldTheCpusPicturesToo) {
  Registry<Reconstructor>::add("broken", [](const Rig&) -> std::unique_ptr<Reconstructor> {
    class Broken : public Reconstructor {
      void reconstruct(const FrameSet&, const DepthImages&, const Poses&, const OcclusionMasks&,
                       const TiledRegion&, const Options&, Reconstruction&) override {
        throw Error("the driver lost the context");
      }
    };
    return std::make_unique<Broken>();
  });
  for (const char* what : {"cpu", "broken", "telea", "poisson"}) {
    Options options = testing::gpu_options();
    const std::string name = what;
    options.backend = name == "cpu" || name == "broken" ? name : "gl";
    if (name == "telea") options.inpaint = name;
    if (name == "poisson") options.color_correct = name;
    Pipeline downloading(scene.recording.rig, scene.recording.scene, options);
    DiminishedFrame expected;
    downloading.process(scene.frame, expected);
    pipeline.set_options(options);
    pipeline.process(scene.frame, result);
    EXPECT_EQ(application.shown(pipeline.texture()), expected.picture) << name;
    EXPECT_EQ(result.picture, expected.picture) << name;
    EXPECT_EQ(result.provenance, expected.provenance) << name;
    EXPECT_THAT(result.report.messages, Contains(by_cpu)) << name;
  }
}

TEST_F(Textures, HoldTheCamerasPictureWhereNothingIsRemoved) {
  Options options = on_gpu();
  options.keep = scene.recording.scene.occluders.front().name;
  pipeline.set_options(options);
  pipeline.process(scene.frame, result);
  EXPECT_EQ(application.shown(pipeline.texture()), scene.frame.color.own());
  EXPECT_TRUE(result.picture.empty());
  EXPECT_THAT(result.report.messages, ::testing::Not(Contains(by_cpu)));
}

TEST_F(Textures, AreNotThereWithoutAPicture) {
  pipeline.process(scene.frame, result);
  EXPECT_NE(pipeline.texture().name, 0U);
  FrameSet skipped = scene.frame;
  skipped.color.own().resize(0, 0);
  pipeline.process(skipped, result);
  EXPECT_EQ(pipeline.texture().name, 0U);
  pipeline.process(scene.frame, result);
  EXPECT_NE(pipeline.texture().name, 0U);
}

// The pipeline's context is made anew; with the reconstruction, where that is wanted.
TEST_F(Textures, MayBeWantedByOneApplicationAfterTheOther) {
  Pipeline downloading(scene.recording.rig, scene.recording.scene, on_gpu());
  DiminishedFrame expected;
  downloading.process(scene.frame, expected);
  pipeline.want_texture(std::nullopt);
  pipeline.process(scene.frame, result);
  EXPECT_EQ(pipeline.texture().name, 0U);
  EXPECT_EQ(result.picture, expected.picture);
  {
    const Application other;
    pipeline.want_texture(other.sharing());
    pipeline.process(scene.frame, result);
    EXPECT_EQ(other.shown(pipeline.texture()), expected.picture);
    EXPECT_EQ(result.reconstruction.color, expected.reconstruction.color);
    EXPECT_EQ(result.surfaces.label, expected.surfaces.label);
  }
  // Its context is gone; the textures are not.
  pipeline.process(scene.frame, result);
  EXPECT_NE(pipeline.texture().name, 0U);
  EXPECT_TRUE(result.picture.empty());
  pipeline.want_texture(application.sharing());
  pipeline.process(scene.frame, result);
  EXPECT_EQ(application.shown(pipeline.texture()), expected.picture);
  pipeline.want_texture(std::nullopt);
  pipeline.process(scene.frame, result);
  EXPECT_EQ(result.picture, expected.picture);
}

TEST_F(Textures, OfAnApplicationThatCannotBeSharedWithAreAnError) {
  const GlSharing right = application.sharing();
  const auto error = [&](const GlSharing& wrong) {
    return error_of([&] { pipeline.want_texture(wrong); });
  };
  int nothing = 0;
  EXPECT_THAT(error({right.egl_display, nullptr}), HasSubstr("got null"));
  EXPECT_THAT(error({nullptr, right.egl_context}), HasSubstr("got null"));
  EXPECT_THAT(error({&nothing, right.egl_context}), HasSubstr("EGL_BAD_DISPLAY"));
  EXPECT_THAT(error({right.egl_display, &nothing}), HasSubstr("EGL_BAD_CONTEXT"));
  EXPECT_THAT(error(application.sharing(0)), HasSubstr("expected at least 1, got 0"));
  eglBindAPI(EGL_OPENGL_ES_API);
  constexpr EGLint second[] = {EGL_CONTEXT_MAJOR_VERSION, 2, EGL_NONE};
  const EGLContext embedded =
      eglCreateContext(right.egl_display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, second);
  ASSERT_NE(embedded, EGL_NO_CONTEXT);
  EXPECT_THAT(error({right.egl_display, embedded}), HasSubstr("OpenGL, got another API"));
  eglDestroyContext(right.egl_display, embedded);
  // Nothing is left of it.
  pipeline.process(scene.frame, result);
  EXPECT_EQ(pipeline.texture().name, 0U);
  EXPECT_FALSE(result.picture.empty());
}

}  // namespace
}  // namespace diminish
