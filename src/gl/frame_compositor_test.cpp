#include "gl/frame_compositor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <optional>

#include "composite/color_maps.h"
#include "composite/compositor.h"
#include "core/mat.h"
#include "diminish/view_mode.h"
#include "gl/context.h"
#include "lit_wall.h"
#include "picture_difference.h"
#include "reconstruct/clear_outside.h"

namespace diminish {
namespace {

/// A made-up reconstruction of a lit wall with bumps and holes, from two cameras with colours of
/// their own, and a ragged object.
class Composition : public ::testing::Test, protected testing::LitWall {
 protected:
  Composition()
      : frame({}, {{-0.45, 0.3, 0.9}, {0.4, 0.2, 1}}), planes(rig.color), shadows(rig.color) {
    planes.find({100, 80, 100, 90}, at_pixels(samples));
    shadows.find(planes.planes(), samples, box_points);
    masks = testing::empty_masks(frame.rig);
    depths = testing::depths_of(frame.frame);
    remove_blobs();
    make_picture();
    make_reconstruction();
  }

  std::vector<SceneSample>& at_pixels(std::vector<SceneSample>& all) {
    const Lens lens(rig.color);
    for (std::size_t i = 0; i < all.size(); ++i) {
      SceneSample& sample = all[i];
      if (const auto pixel = lens.project(sample.point_m.cast<double>())) {
        sample.pixel = pixel->cast<float>();
      }
      sample.even = true;
      sample.source = i < all.size() / 2 ? 1 : 2;
    }
    return all;
  }

  void remove_blobs() {
    for (int i = 0; i < 7; ++i) {
      const cv::Point middle(region.x + 40 + static_cast<int>(random() % 160),
                             region.y + 30 + static_cast<int>(random() % 130));
      cv::circle(as_mat(masks.color), middle, 6 + static_cast<int>(random() % 24), 255, cv::FILLED);
    }
  }

  /// Noise over gradients, and lines.
  void make_picture() {
    for (int y = 0; y < frame.frame.color.height(); ++y) {
      for (int x = 0; x < frame.frame.color.width(); ++x) {
        const auto level = [&](int base) {
          return static_cast<std::uint8_t>(base + static_cast<int>(random() % 9));
        };
        frame.frame.color(x, y) = {level(60 + x / 4), level(150 - y / 3), level(90 + (x + y) / 8)};
        if (masks.color(x, y) != 0 && (x + 2 * y) % 19 < 3) frame.frame.color(x, y).g += 90;
      }
    }
  }

  void make_reconstruction() {
    Reconstruction& made = expected.reconstruction;
    clear_outside(frame.rig.color, region, made);
    made.samples = samples;
    resize_second(true, frame.rig.color, made.second);
    made.second.share.fill(0);
    made.second.color.fill({});
    made.second.source.fill(0);
    const Lens lens(rig.color);
    for (int y = region.y; y < region.bottom(); ++y) {
      for (int x = region.x; x < region.right(); ++x) {
        if (random() % 16 == 0 || (x / 23 + y / 17) % 5 == 0) continue;  // holes, small and large
        const Eigen::Vector2f ray = lens.undistort({x, y}).cast<float>();
        const float bump_m = (x / 31 + y / 29) % 3 == 0 ? 0.001F * static_cast<float>(x % 80) : 0.F;
        made.depth_m(x, y) = 1 / plane.inverse_depth(ray.x(), ray.y()) - bump_m;
        made.source(x, y) = static_cast<std::uint8_t>(1 + (x + y / 3) / 100 % 2);
        const Bgr& seen = frame.frame.color(x, y);
        const auto dyed = [&](int level, double gain) {
          return static_cast<std::uint8_t>(std::clamp(gain * level + 4, 0.0, 255.0));
        };
        const double gain = made.source(x, y) == 1 ? 0.8 : 1.2;
        made.color(x, y) = {dyed(seen.b, gain), dyed(seen.g, 0.9), dyed(seen.r, 1 / gain), 255};
        if ((x / 41 + y / 37) % 3 == 0) continue;
        made.second.color(x, y) = {dyed(seen.b, 1), dyed(seen.g, gain), dyed(seen.r, 1), 255};
        made.second.source(x, y) = static_cast<std::uint8_t>(3 - made.source(x, y));
        made.second.share(x, y) = static_cast<std::uint8_t>(1 + random() % 128);
      }
    }
  }

  /// By the stages of the processor.
  void compose_by_processor(bool with_shadows) {
    Reconstruction& made = expected.reconstruction;
    planes.label(made);
    if (with_shadows) {
      shadows.shade(made);
    } else {
      made.light.resize(0, 0);
    }
    compositor.composite(frame.frame.color, masks, options, expected);
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
    if (const MappedMethod* method = find_mapped_method(options.color_correct)) {
      maps.fit(frame.frame.color, masks.color, samples, method->model);
    } else {
      maps.clear();
    }
    const auto cast = with_shadows ? shadows.shadows() : std::span<const CastShadows::Shadow>();
    const FrameInputs inputs{
        frame.frame, depths,  frame.poses,      masks, bounding_box(masks.color),
        region,      options, &planes.planes(), cast,  maps.by_source(),
        true};
    const Image<Bgr>& camera = frame.frame.color;
    result.picture = camera;
    result.provenance.resize(camera.width(), camera.height(), provenance::camera);
    clear_outside(frame.rig.color, region, result.reconstruction);
    resize_second(!expected.reconstruction.second.share.empty(), frame.rig.color,
                  result.reconstruction.second);
    const gl::Current current(context);
    if (!on_gpu) {
      on_gpu.emplace(frame.rig);
      upload.emplace(frame.rig, gl::FrameCompositor::most_added_bytes(frame.rig));
    }
    upload->pack(frame.frame, depths, frame.poses, masks, region, options);
    on_gpu->pack(inputs, *upload);
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
    const gl::Current current(context);
    on_gpu.reset();
    upload.reset();
  }

  static constexpr std::size_t most_others = 100;
  Rect region{37, 21, 251, 203};
  testing::AnalyticFrame frame;
  BackgroundPlanes planes;
  CastShadows shadows;
  OcclusionMasks masks;
  DepthImages depths;
  Options options;
  ColorMaps maps;
  Compositor compositor;
  DiminishedFrame expected, result;
  gl::Context context;
  std::optional<gl::FrameUpload> upload;
  std::optional<gl::FrameCompositor> on_gpu;
};

TEST_F(Composition, LabelsAndLightAreTheProcessors) {
  ASSERT_TRUE(shadows.any());
  compose_by_processor(true);
  compose_on_gpu(true);
  const Reconstruction& a = expected.reconstruction;
  const Reconstruction& b = result.reconstruction;
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
      other_labels += a.surface(x, y) != b.surface(x, y) ? 1U : 0U;
      ++by_label[a.surface(x, y)];
      shaded += a.light(x, y) != Bgr{255, 255, 255} ? 1U : 0U;
    }
  }
  EXPECT_LE(other_labels, 5U);
  EXPECT_LE(other_colors(a.light, b.light), 10U);
  EXPECT_GT(by_label[surface_label::first_plane], 10000U);
  EXPECT_GT(by_label[surface_label::foreground], 1000U);
  EXPECT_GT(shaded, 1000U);
}

// Pass by pass: what is sorted, then mapped, then with the membrane, then without shadows.
TEST_F(Composition, ColorsAreTheProcessors) {
  options.inpaint = "none";
  options.soft_rim_px = 0;
  for (const char* method : {"none", "affine", "field", "affine_membrane", "field_membrane"}) {
    options.color_correct = method;
    ASSERT_EQ(gl::FrameCompositor::reach(options), Reach::picture);
    for (const bool with_shadows : {false, true}) {
      compose_by_processor(with_shadows);
      compose_on_gpu(with_shadows);
      expect_same(std::string(method) + (with_shadows ? ", lifted" : ""));
      EXPECT_GT(expected.report.valid_pixels, 1000U);
      EXPECT_GT(expected.report.missing_pixels, 1000U);
    }
  }
}

TEST_F(Composition, ShadowsOutsideStayOrGo) {
  options.inpaint = "none";
  for (const bool removed : {false, true}) {
    options.remove_shadows = removed;
    compose_by_processor(true);
    compose_on_gpu(true);
    expect_same(removed ? "removed" : "restored");
    std::size_t changed = 0;
    for (std::size_t i = 0; i < masks.color.size(); ++i) {
      const bool other = result.picture.data()[i] != frame.frame.color.data()[i];
      changed += masks.color.data()[i] == 0 && other ? 1U : 0U;
    }
    EXPECT_EQ(changed > 0, removed);
  }
}

TEST_F(Composition, RimsAreTheProcessors) {
  options.inpaint = "none";
  options.mask_margin_px = 14;
  for (const int width_px : {1, 2, 7}) {
    options.soft_rim_px = width_px;
    compose_by_processor(false);
    compose_on_gpu(false);
    expect_same(std::to_string(width_px));
  }
}

// Also where the object reaches the picture's border.
TEST_F(Composition, ViewModesAreTheProcessors) {
  options.inpaint = "none";
  options.transparency = 0.3;
  region = frame.rig.color.bounds();
  make_reconstruction();
  masks.color.fill({0, 50, 40, 20}, 255);
  masks.color.fill({90, 236, 40, 20}, 255);
  for (const std::string& mode : Registry<ViewMode>::names()) {
    options.mode = mode;
    ASSERT_EQ(gl::FrameCompositor::reach(options), Reach::picture) << mode;
    compose_by_processor(true);
    compose_on_gpu(true);
    expect_same(mode);
  }
}

// What the GPU does not do is left to the processor.
TEST(FrameCompositor, SaysHowFarItGoes) {
  Options options;
  options.inpaint = "harmonic";
  EXPECT_EQ(gl::FrameCompositor::reach(options), Reach::seen);
  options.color_correct = "poisson";
  EXPECT_EQ(gl::FrameCompositor::reach(options), Reach::reconstruction);
  options.color_correct = "none";
  options.inpaint = "none";
  EXPECT_EQ(gl::FrameCompositor::reach(options), Reach::picture);
  options.mode = "another";
  EXPECT_EQ(gl::FrameCompositor::reach(options), Reach::seen);
}

}  // namespace
}  // namespace diminish
