#include "gl/frame_compositor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "compose.h"
#include "diminish/view_mode.h"
#include "diminished_wall.h"
#include "gl/context.h"
#include "gpu_options.h"
#include "picture_difference.h"
#include "scene/color_maps.h"

namespace diminish {
namespace {

class Composition : public ::testing::Test, protected testing::DiminishedWall {
 protected:
  /// By the stages of the CPU.
  void compose_on_cpu(bool with_shadows) {
    const Reconstruction& made = expected.reconstruction;
    planes.label(made, expected.surfaces);
    if (with_shadows) {
      shadows.shade(made, expected.surfaces);
    } else {
      expected.surfaces.light.resize(0, 0);
    }
    composing.compose(frame.frame.color.own(), masks.color, options, samples, expected);
  }

  FrameMethods methods() const {
    return {Registry<ColorCorrector>::get(options.color_correct)()->declaration(),
            Registry<Inpainter>::get(options.inpaint)()->declaration(), options.mode};
  }

  template <class Pixel, class PixelAt>
  void send(gl::Buffer& buffer, const PixelAt& pixel_at) {
    const std::size_t bytes = gl::pixels_of(region) * sizeof(Pixel);
    gl::MappedBuffer staging(gl::MappedBuffer::Use::upload);
    buffer.reserve(bytes);
    staging.reserve(bytes);
    auto* pixel = reinterpret_cast<Pixel*>(staging.data());
    for (int y = region.y; y < region.bottom(); ++y) {
      for (int x = region.x; x < region.right(); ++x) *pixel++ = pixel_at(x, y);
    }
    gl::copy(staging.name(), buffer.name(), bytes);
  }

  void compose_on_gpu(bool with_shadows) {
    const FrameMethods declared = methods();
    maps.fit(frame.frame.color, masks.color, samples, declared.color.maps);
    const auto cast = with_shadows ? shadows.shadows() : std::span<const CastShadow>();
    const FrameInputs inputs{frame.frame,
                             depths,
                             frame.poses,
                             masks,
                             bounding_box(masks.color),
                             region,
                             options,
                             declared,
                             &planes.planes(),
                             cast,
                             maps.by_source(),
                             composing.smoothing_share,
                             true};
    const Image<Bgr>& camera = frame.frame.color.own();
    result.picture = camera;
    result.provenance.resize(camera.width(), camera.height(), provenance::camera);
    clear_outside(frame.rig.color, region, result.reconstruction);
    resize_second(!expected.reconstruction.second.share.empty(), frame.rig.color,
                  result.reconstruction.second);
    context.run([&] { compose_in_context(inputs); });
  }

  void compose_in_context(const FrameInputs& inputs) {
    if (!on_gpu) {
      on_gpu.emplace(frame.rig);
      upload.emplace(frame.rig, gl::FrameCompositor::most_added_bytes(frame.rig));
    }
    upload->pack(frame.frame, depths, frame.poses, masks, region, options);
    on_gpu->pack(inputs, Stage::finish, *upload);
    upload->send();
    gl::ResultBuffers reconstruction;
    const Reconstruction& made = expected.reconstruction;
    const SecondView& second = made.second;
    send<gl::ResultPixel>(reconstruction.first, [&](int x, int y) -> gl::ResultPixel {
      const Bgra& color = made.color(x, y);
      return {color.b, color.g, color.r, made.source(x, y), made.depth_m(x, y)};
    });
    ASSERT_EQ(upload->blends(), !second.share.empty());
    if (upload->blends()) {
      send<gl::SecondPixel>(reconstruction.second, [&](int x, int y) -> gl::SecondPixel {
        const Bgra& color = second.color(x, y);
        return {color.b, color.g, color.r, second.source(x, y), second.share(x, y)};
      });
    }
    gl::PassTimer timer(true);
    timer.begin_frame();
    on_gpu->run(inputs, *upload, reconstruction, timer);
    gl::wait_until_done();
    context.check("a test");
    on_gpu->read(inputs, *upload, result);
  }

  /// Of the region's pixels, those whose colours differ; by more than a level counts a hundredfold.
  std::size_t other_colors(const Image<Bgr>& a, const Image<Bgr>& b) const {
    std::size_t count = 0;
    for (int y = region.y; y < region.bottom(); ++y) {
      for (int x = region.x; x < region.right(); ++x) {
        const int levels = testing::difference(a(x, y), b(x, y));
        count += levels > 1 ? 100U : levels > 0 ? 1U : 0U;
      }
    }
    return count;
  }

  void expect_same(const std::string& what) {
    EXPECT_EQ(result.report.mask_pixels, expected.report.mask_pixels) << what;
    EXPECT_EQ(result.report.missing_pixels, expected.report.missing_pixels) << what;
    EXPECT_EQ(result.report.valid_pixels, expected.report.valid_pixels) << what;
    EXPECT_EQ(result.provenance, expected.provenance) << what;
    EXPECT_LE(other_colors(result.picture, expected.picture), most_others) << what;
  }

  void TearDown() override {
    context.run([&] {
      on_gpu.reset();
      upload.reset();
    });
  }

  static constexpr std::size_t most_others = 100;
  Options options = testing::gpu_options();
  ColorMaps maps;
  testing::Composing composing;
  DiminishedFrame result;
  gl::Context context;
  std::optional<gl::FrameUpload> upload;
  std::optional<gl::FrameCompositor> on_gpu;
};

TEST_F(Composition, LabelsAndLightAreTheCpus) {
  ASSERT_TRUE(shadows.any());
  compose_on_cpu(true);
  compose_on_gpu(true);
  const Reconstruction& a = expected.reconstruction;
  const Reconstruction& b = result.reconstruction;
  const Surfaces& cpu_surfaces = expected.surfaces;
  const Surfaces& gpu_surfaces = result.surfaces;
  EXPECT_EQ(a.color, b.color);
  EXPECT_EQ(a.depth_m, b.depth_m);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.second.color, b.second.color);
  EXPECT_EQ(a.second.source, b.second.source);
  EXPECT_EQ(a.second.share, b.second.share);
  std::size_t other_labels = 0;
  std::size_t by_label[256] = {};
  std::size_t shaded = 0;
  for (int y = region.y; y < region.bottom(); ++y) {
    for (int x = region.x; x < region.right(); ++x) {
      other_labels += cpu_surfaces.label(x, y) != gpu_surfaces.label(x, y) ? 1U : 0U;
      ++by_label[cpu_surfaces.label(x, y)];
      shaded += cpu_surfaces.light(x, y) != Bgr{255, 255, 255} ? 1U : 0U;
    }
  }
  EXPECT_LE(other_labels, 5U);
  EXPECT_LE(other_colors(cpu_surfaces.light, gpu_surfaces.light), 10U);
  EXPECT_GT(by_label[surface_label::first_plane], 10000U);
  EXPECT_GT(by_label[surface_label::foreground], 1000U);
  EXPECT_GT(shaded, 1000U);
}

// Pass by pass: what is sorted, then mapped, then with the membrane, then without shadows.
TEST_F(Composition, ColorsAreTheCpus) {
  composing.smoothing_share = 90;
  options.inpaint = "none";
  options.soft_rim_px = 0;
  for (const char* merge : {"blend", "choose"}) {
    options.merge_cameras = merge;
    if (options.merge_cameras == "choose")
      resize_second(false, rig.color, expected.reconstruction.second);
    for (const char* method : {"none", "affine", "field", "affine_membrane", "field_membrane"}) {
      options.color_correct = method;
      ASSERT_TRUE(gl::FrameCompositor::takes_over(Stage::colors, methods()));
      for (const bool with_shadows : {false, true}) {
        compose_on_cpu(with_shadows);
        compose_on_gpu(with_shadows);
        expect_same(std::string(merge) + ", " + method + (with_shadows ? ", lifted" : ""));
        EXPECT_GT(expected.report.valid_pixels, 1000U);
        EXPECT_GT(expected.report.missing_pixels, 1000U);
      }
    }
  }
}

TEST_F(Composition, ShadowsOutsideStayOrGo) {
  options.inpaint = "none";
  for (const bool removed : {false, true}) {
    options.remove_shadows = removed;
    compose_on_cpu(true);
    compose_on_gpu(true);
    expect_same(removed ? "removed" : "restored");
    std::size_t changed = 0;
    for (std::size_t i = 0; i < masks.color.size(); ++i) {
      const bool other = result.picture.data()[i] != frame.frame.color.view().data()[i];
      changed += masks.color.data()[i] == 0 && other ? 1U : 0U;
    }
    EXPECT_EQ(changed > 0, removed);
  }
}

TEST_F(Composition, RimsAreTheCpus) {
  options.inpaint = "none";
  options.mask_margin_px = 14;
  for (const int width_px : {1, 2, 7}) {
    options.soft_rim_px = width_px;
    compose_on_cpu(false);
    compose_on_gpu(false);
    expect_same(std::to_string(width_px));
  }
}

// Also where the object reaches the picture's border.
TEST_F(Composition, ViewModesAreTheCpus) {
  options.inpaint = "none";
  options.transparency = 0.3;
  region = frame.rig.color.bounds();
  make_reconstruction();
  masks.color.fill({0, 50, 40, 20}, 255);
  masks.color.fill({90, 236, 40, 20}, 255);
  for (const std::string& mode : Registry<ViewMode>::names()) {
    options.mode = mode;
    ASSERT_TRUE(gl::FrameCompositor::takes_over(Stage::finish, methods())) << mode;
    compose_on_cpu(true);
    compose_on_gpu(true);
    expect_same(mode);
  }
}

// What the GPU does not do is left to the CPU, stage by stage.
TEST(FrameCompositor, SaysWhatItTakesOver) {
  const auto takes = [](Stage stage, const char* correction, const char* inpainting,
                        const char* mode) {
    return gl::FrameCompositor::takes_over(
        stage, {Registry<ColorCorrector>::get(correction)()->declaration(),
                Registry<Inpainter>::get(inpainting)()->declaration(), mode});
  };
  EXPECT_FALSE(takes(Stage::depth, "none", "none", "remove"));
  EXPECT_TRUE(takes(Stage::compositing, "field_membrane", "harmonic", "remove"));
  EXPECT_TRUE(takes(Stage::colors, "field_membrane", "harmonic", "remove"));
  EXPECT_FALSE(takes(Stage::inpainting, "field_membrane", "harmonic", "remove"));
  EXPECT_FALSE(takes(Stage::compositing, "poisson", "harmonic", "remove"));
  EXPECT_TRUE(takes(Stage::inpainting, "none", "none", "remove"));
  EXPECT_TRUE(takes(Stage::finish, "affine", "surfaces", "xray"));
  EXPECT_FALSE(takes(Stage::finish, "affine", "surfaces", "another"));
}

}  // namespace
}  // namespace diminish
