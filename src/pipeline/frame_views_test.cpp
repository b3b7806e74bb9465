#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "diminish/error.h"
#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "diminish/reconstructor.h"
#include "expect_error.h"
#include "paths.h"

namespace diminish {
namespace {

/// Pixels as a driver may deliver them: rows that do not follow one another, with `filler` between.
template <class Pixel>
class PaddedImage {
 public:
  PaddedImage(const ImageView<Pixel>& image, std::byte filler)
      : width_(image.width()),
        height_(image.height()),
        stride_((width_ * sizeof(Pixel) / 32 + 2) * 32),
        bytes_(stride_ * static_cast<std::size_t>(height_), filler) {
    // Nothing follows the last row.
    bytes_.resize(bytes_.size() - stride_ + width_ * sizeof(Pixel));
    bytes_.shrink_to_fit();
    for (int y = 0; y < height_; ++y) {
      std::copy_n(reinterpret_cast<const std::byte*>(image.row(y)), width_ * sizeof(Pixel),
                  bytes_.begin() + static_cast<std::ptrdiff_t>(stride_) * y);
    }
  }
  ImageView<Pixel> view() const {
    return {reinterpret_cast<const Pixel*>(bytes_.data()), width_, height_,
            static_cast<std::ptrdiff_t>(stride_)};
  }

 private:
  int width_, height_;
  std::size_t stride_;
  std::vector<std::byte> bytes_;
};

/// A frame whose images are views of padded ones.
struct PaddedFrame {
  PaddedFrame(const FrameSet& original, std::byte filler) : frame(original) {
    color.emplace_back(original.color.view(), filler);
    for (const RgbdFrame& rgbd : original.rgbd) {
      color.emplace_back(rgbd.color.view(), filler);
      depth.emplace_back(rgbd.depth.view(), filler);
    }
    frame.color = color[0].view();
    for (std::size_t k = 0; k < depth.size(); ++k) {
      frame.rgbd[k].color = color[k + 1].view();
      frame.rgbd[k].depth = depth[k].view();
    }
  }

  FrameSet frame;
  std::vector<PaddedImage<Bgr>> color;
  std::vector<PaddedImage<std::uint16_t>> depth;
};

class FrameViews : public ::testing::TestWithParam<const char*> {
 protected:
  Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / GetParam());
};
INSTANTIATE_TEST_SUITE_P(Recordings, FrameViews, ::testing::Values("calendar", "ball", "workbench"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(FrameViews, GiveTheSamePictureWhateverLiesBetweenTheirRows) {
  FrameSet frame;
  ASSERT_TRUE(open_recording(recording, {})->next(frame));
  Options options;
  options.remove_shadows = true;
  for (const std::string& backend : Registry<Reconstructor>::names()) {
    options.backend = backend;
    Pipeline pipeline(recording.rig, recording.scene, options);
    DiminishedFrame expected;
    pipeline.process(frame, expected);
    ASSERT_GT(expected.report.valid_pixels, 1000U) << backend;
    for (const int filler : {0, 255}) {
      const PaddedFrame padded(frame, static_cast<std::byte>(filler));
      DiminishedFrame result;
      pipeline.forget();  // the bars that were found
      pipeline.process(padded.frame, result);
      EXPECT_EQ(result.picture, expected.picture) << backend;
      EXPECT_EQ(result.mask, expected.mask) << backend;
      EXPECT_EQ(result.provenance, expected.provenance) << backend;
    }
  }
}

TEST(InputImage, ShowsAViewsPixelsWhereTheyAre) {
  const Image<Bgr> pixels(5, 4, {1, 2, 3});
  const PaddedImage<Bgr> padded(pixels, std::byte{7});
  const InputImage<Bgr> image = padded.view();
  EXPECT_EQ(image.row(0), padded.view().data());
  EXPECT_EQ(image(4, 3), (Bgr{1, 2, 3}));
  EXPECT_EQ(image.bounds(), (Rect{0, 0, 5, 4}));
}

TEST(InputImage, ACopyKeepsItsPixels) {
  Image<Bgr> pixels(5, 4, {1, 2, 3});
  const InputImage<Bgr> image = ImageView<Bgr>(pixels);
  InputImage<Bgr> copy;
  copy = image;
  pixels.fill({9, 9, 9});
  EXPECT_EQ(image(4, 3), (Bgr{9, 9, 9}));
  EXPECT_EQ(copy(4, 3), (Bgr{1, 2, 3}));
}

TEST(InputImage, PixelsOfItsOwnTakeTheViewsPlace) {
  const Image<Bgr> pixels(5, 4, {1, 2, 3});
  InputImage<Bgr> image = ImageView<Bgr>(pixels);
  image.own().resize(2, 2, {4, 5, 6});
  EXPECT_EQ(image.width(), 2);
  EXPECT_EQ(image(1, 1), (Bgr{4, 5, 6}));
  EXPECT_EQ(pixels(1, 1), (Bgr{1, 2, 3}));
}

TEST(ImageStrides, RowsThatOverlapAreAnErrorThatNamesTheCamera) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "calendar");
  FrameSet frame;
  ASSERT_TRUE(open_recording(recording, {})->next(frame));
  Pipeline pipeline(recording.rig, recording.scene, {});
  const InputImage<std::uint16_t> depth = frame.rgbd[0].depth;
  DiminishedFrame result;
  for (const int stride : {depth.width(), 2 * depth.width() + 1, -2 * depth.width()}) {
    frame.rgbd[0].depth =
        ImageView<std::uint16_t>(depth.row(0), depth.width(), depth.height(), stride);
    EXPECT_THAT(error_of([&] { pipeline.process(frame, result); }),
                ::testing::AllOf(::testing::HasSubstr(recording.rig.rgbd[0].name + " depth"),
                                 ::testing::HasSubstr("stride"),
                                 ::testing::HasSubstr(std::to_string(stride))));
  }
}

}  // namespace
}  // namespace diminish
