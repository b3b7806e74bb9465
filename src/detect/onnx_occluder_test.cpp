#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analytic_scene.h"
#include "detection.h"
#include "expect_error.h"
#include "mask_overlap.h"
#include "onnx_model.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Networks that find red, in a picture whose sides the input is half of.
class OnnxOccluderTest : public ::testing::Test {
 protected:
  OnnxOccluderTest() {
    detection.frame.color.own().fill(Bgr{90, 120, 100});
    detection.frame.color.own().fill(object, {20, 30, 220});
    detection.frame.rgbd[0].color.own().fill(Bgr{200, 200, 200});
    detection.frame.rgbd[0].color.own().fill(rgbd_object, {40, 20, 200});
  }

  std::unique_ptr<OccluderDetector> make(const std::string& more) const {
    return make_detector("name: red\ndetector: onnx\nmodel: m.onnx\n" + more, detection.rig,
                         folder.path() / "s.yaml");
  }
  void write(const std::vector<std::vector<float>>& weights, const std::vector<float>& offsets,
             int width = 160, int height = 128) const {
    testing::OnnxModel::write(folder.path() / "m.onnx", weights, offsets, width, height);
  }
  void expect_found(const std::string& settings) {
    SCOPED_TRACE(settings);
    const auto detector = make(settings);
    const OccluderReport report = detection.detect(*detector);
    EXPECT_TRUE(report.in_color && report.in_rgbd[0]);
    Mask expected(detection.rig.color.width, detection.rig.color.height);
    expected.fill(object, 255);
    EXPECT_GT(intersection_over_union(detection.masks.color, expected), 0.9);
    const Intrinsics& rgbd = detection.rig.rgbd[0].color;
    Mask in_rgbd(rgbd.width, rgbd.height);
    in_rgbd.fill(rgbd_object, 255);
    EXPECT_GT(intersection_over_union(detection.masks.rgbd_color[0], in_rgbd), 0.9);
  }

  static constexpr Rect object{100, 60, 80, 100};
  static constexpr Rect rgbd_object{50, 90, 120, 120};
  TemporaryFolder folder;
  Detection detection{testing::small_rig()};
};

TEST_F(OnnxOccluderTest, OneChannelIsComparedWithTheThreshold) {
  write({{1, -0.5F, -0.5F}}, {0.1F});
  expect_found("size: [160, 128]\nthreshold: 0.5");
}

TEST_F(OnnxOccluderTest, OfSeveralClassesTheGreatestWins) {
  write({{0, 0, 0}, {1, -0.5F, -0.5F}, {-1, 0, 0}}, {0.4F, 0, 0});
  expect_found("size: [160, 128]");
  expect_found("size: [160, 128]\nclasses: [1, 2]");
  const auto other = make("size: [160, 128]\nclasses: [2]");
  EXPECT_FALSE(detection.detect(*other).in_color);
}

/// The same network with other numbers for its input.
TEST_F(OnnxOccluderTest, TheInputIsScaledAndOrdered) {
  write({{-0.5F, -0.5F, 1}}, {0});
  expect_found("size: [160, 128]\nchannels: bgr\nthreshold: 0.4");
  write({{1, -0.5F, -0.5F}}, {0});
  expect_found("size: [160, 128]\nscale: 0.01\nmean: [100, 0, 0]\nthreshold: 0.1");
}

TEST_F(OnnxOccluderTest, ACameraWithoutImagesIsLeftAlone) {
  write({{1, -0.5F, -0.5F}}, {0});
  const auto detector = make("size: [160, 128]\nthreshold: 0.4");
  detection.frame.rgbd[0].missing = "late";
  const OccluderReport report = detection.detect(*detector);
  EXPECT_TRUE(report.in_color);
  EXPECT_FALSE(report.in_rgbd[0]);
  EXPECT_FALSE(any_set(detection.masks.rgbd_color[0]));
}

TEST_F(OnnxOccluderTest, WrongModelsAndSettingsAreOneLine) {
  const auto error_with = [&](const std::string& settings) {
    std::string error = error_of([&] { make(settings); });
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    return error;
  };
  const std::string size = "size: [160, 128]";
  EXPECT_THAT(error_with(size), AllOf(HasSubstr("s.yaml:3: model"), HasSubstr("m.onnx")));
  std::ofstream(folder.path() / "m.onnx") << "not a network";
  EXPECT_THAT(error_with(size), AllOf(HasSubstr("s.yaml:3: model"), HasSubstr("ONNX")));
  write({{1, 0, 0}, {0, 1, 0}}, {0, 0});
  EXPECT_THAT(error_with(size + "\nclasses: [2]"), HasSubstr("has 2 classes"));
  write({{1, 0, 0, 0}}, {0});
  EXPECT_THAT(error_with(size), HasSubstr("does not take a picture of 160x128 pixels"));
  EXPECT_THAT(error_with("size: [4, 128]"), HasSubstr("s.yaml:4: size"));
  EXPECT_THAT(error_with(size + "\nchannels: yuv"), HasSubstr("s.yaml:5: channels"));
  EXPECT_THAT(error_with(size + "\nscale: -1"), HasSubstr("s.yaml:5: scale"));
  EXPECT_THAT(error_with(size + "\nevery: 0"), HasSubstr("s.yaml:5: every"));
  EXPECT_THAT(error_with(size + "\nsteady: 2"), HasSubstr("s.yaml:5: steady"));
}

}  // namespace
}  // namespace diminish
