#include "composite/compositor.h"

#include <gtest/gtest.h>

#include <opencv2/photo.hpp>
#include <random>

#include "compose.h"
#include "core/mat.h"

namespace diminish {
namespace {

/// A picture with a mask whose left half was reconstructed.
class Compositing : public ::testing::Test {
 protected:
  Compositing() {
    std::mt19937 random(1);
    camera.resize(120, 90);
    for (int y = 0; y < 90; ++y) {
      for (int x = 0; x < 120; ++x) {
        const auto level = static_cast<std::uint8_t>(60 + x / 2 + y / 2 + random() % 8);
        camera(x, y) = {level, static_cast<std::uint8_t>(255 - level), 77};
      }
    }
    masks.color.resize(120, 90, 0);
    masks.color.fill({30, 20, 50, 40}, 255);
    result.reconstruction.region = Rect{20, 10, 70, 60};
    result.reconstruction.color.resize(120, 90, {});
    result.reconstruction.depth_m.resize(120, 90, 0.F);
    result.reconstruction.source.resize(120, 90, 0);
    for (int y = 10; y < 70; ++y) {
      for (int x = 20; x < 55; ++x) {
        result.reconstruction.color(x, y) = {10, 20, 30, 255};
        result.reconstruction.source(x, y) = 1;
      }
    }
  }
  bool masked(int x, int y) const { return masks.color(x, y) != 0; }

  Image<Bgr> camera;
  OcclusionMasks masks;
  DiminishedFrame result;
  Options options;
  testing::Composing composing;
};

TEST_F(Compositing, LeavesEverythingOutsideTheMaskAlone) {
  for (const std::string& correction : Registry<ColorCorrector>::names()) {
    for (const std::string& inpainting : Registry<Inpainter>::names()) {
      options.color_correct = correction;
      options.inpaint = inpainting;
      composing.compose(camera, masks.color, options, {}, result);
      for (int y = 0; y < 90; ++y) {
        for (int x = 0; x < 120; ++x) {
          if (!masked(x, y)) {
            ASSERT_EQ(result.picture(x, y), camera(x, y)) << correction << ' ' << inpainting;
          }
        }
      }
    }
  }
}

TEST_F(Compositing, SaysWhereEachPixelComesFrom) {
  options.mask_margin_px = 0;  // as it is, so there is no room for a soft rim
  options.color_correct = "none";
  options.inpaint = "none";
  composing.compose(camera, masks.color, options, {}, result);
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      const std::uint8_t expected = !masked(x, y) ? provenance::camera
                                    : x < 55      ? provenance::first_rgbd
                                                  : provenance::unknown;
      ASSERT_EQ(result.provenance(x, y), expected);
      if (masked(x, y)) {
        ASSERT_EQ(result.picture(x, y), x < 55 ? (Bgr{10, 20, 30}) : (Bgr{}));
      }
    }
  }
  EXPECT_EQ(result.report.mask_pixels, 50U * 40U);
  EXPECT_EQ(result.report.valid_pixels, 25U * 40U);
  EXPECT_EQ(result.report.missing_pixels, 25U * 40U);
  options.inpaint = "harmonic";
  result.report = {};
  composing.compose(camera, masks.color, options, {}, result);
  EXPECT_EQ(result.provenance(70, 30), provenance::inpainted);
}

// The result does not depend on what the object looks like.
TEST_F(Compositing, NeverShowsTheObject) {
  options.mask_margin_px = 0;  // as it is, so there is no room for a soft rim
  for (const std::string& inpainting : Registry<Inpainter>::names()) {
    options.inpaint = inpainting;
    composing.compose(camera, masks.color, options, {}, result);
    const Image<Bgr> before = result.picture;
    std::mt19937 random(2);
    for (int y = 0; y < 90; ++y) {
      for (int x = 0; x < 120; ++x) {
        if (masked(x, y)) camera(x, y) = {static_cast<std::uint8_t>(random()), 0, 255};
      }
    }
    composing.compose(camera, masks.color, options, {}, result);
    EXPECT_EQ(result.picture, before) << inpainting;
  }
}

// Only the holes' surroundings are processed; the result equals that of the whole picture.
TEST_F(Compositing, InpaintsAsOpenCvDoesOnTheWholePicture) {
  for (const auto& [name, method] :
       {std::pair("telea", cv::INPAINT_TELEA), std::pair("ns", cv::INPAINT_NS)}) {
    Mask missing(120, 90, 0);
    missing.fill({40, 25, 9, 30}, 255);
    missing.fill({60, 5, 25, 4}, 255);
    cv::Mat expected;
    cv::inpaint(as_mat(camera), as_mat(missing), expected, options.inpaint_radius_px, method);
    Image<Bgr> picture = camera;
    EXPECT_TRUE(
        Registry<Inpainter>::get(name)()->inpaint({missing, missing, {}}, options, picture));
    for (int y = 0; y < 90; ++y) {
      for (int x = 0; x < 120; ++x) {
        const cv::Vec3b& pixel = expected.at<cv::Vec3b>(y, x);
        ASSERT_EQ(picture(x, y),
                  missing(x, y) != 0 ? (Bgr{pixel[0], pixel[1], pixel[2]}) : camera(x, y))
            << name << ' ' << x << ' ' << y;
      }
    }
  }
}

TEST_F(Compositing, APictureOfWhichNothingIsKnownStaysUnknown) {
  masks.color.fill(255);
  result.reconstruction.source.fill(0);
  result.reconstruction.color.fill({});
  composing.compose(camera, masks.color, options, {}, result);
  for (const std::uint8_t value : result.provenance) ASSERT_EQ(value, provenance::unknown);
  for (const Bgr& pixel : result.picture) ASSERT_EQ(pixel, Bgr{});
}

}  // namespace
}  // namespace diminish
