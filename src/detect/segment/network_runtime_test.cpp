#include "detect/segment/network_runtime.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "detect/segment/segmentation_network.h"
#include "expect_error.h"
#include "onnx_model.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int width = 32;
constexpr int height = 24;

class NetworkRuntimes : public ::testing::Test {
 protected:
  std::filesystem::path model() const { return folder.path() / "m.onnx"; }
  std::string error_with(const std::string& runtime) const {
    OnnxSettings settings;
    settings.model = model();
    settings.width = width;
    settings.height = height;
    if (runtime == "opencv") settings.runtime = OnnxSettings::Runtime::opencv;
    if (runtime == "onnxruntime") settings.runtime = OnnxSettings::Runtime::onnxruntime;
    const Config place = Config::parse("model: m.onnx\nruntime: " + runtime, "s.yaml");
    std::string error = error_of([&] { SegmentationNetwork(settings, place); });
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    return error;
  }

  TemporaryFolder folder;
};

class OnnxRuntimes : public NetworkRuntimes {
 protected:
  void SetUp() override {
    if (!has_onnx_runtime()) GTEST_SKIP() << "libonnxruntime.so is not installed";
  }
};

// Both against the sums computed here.
TEST_F(OnnxRuntimes, AnswerLikeOpencvs) {
  const std::vector<std::vector<float>> weights{{0.5F, -1, 0.25F}, {-0.75F, 2, 0.125F}};
  const std::vector<float> offsets{0.1F, -0.2F};
  testing::OnnxModel::write(model(), weights, offsets, width, height);
  const auto opencv = opencv_runtime(model());
  const auto onnx = onnx_runtime(model());
  std::mt19937 random(3);
  std::uniform_real_distribution<float> levels(-1, 1);
  cv::Mat input({1, 3, height, width}, CV_32F);
  constexpr int pixels = width * height;
  for (int round = 0; round < 3; ++round) {
    auto* const in = input.ptr<float>();
    for (int i = 0; i < 3 * pixels; ++i) in[i] = levels(random);
    const cv::Mat other = opencv->run(input);
    const cv::Mat output = onnx->run(input);
    ASSERT_EQ(output.dims, 4);
    ASSERT_EQ(output.size, other.size);
    for (std::size_t c = 0; c < 2; ++c) {
      for (int i = 0; i < pixels; ++i) {
        const float expected = offsets[c] + weights[c][0] * in[i] + weights[c][1] * in[pixels + i] +
                               weights[c][2] * in[2 * pixels + i];
        const int at = static_cast<int>(c) * pixels + i;
        ASSERT_NEAR(output.ptr<float>()[at], expected, 1e-5);
        ASSERT_NEAR(other.ptr<float>()[at], expected, 1e-5);
      }
    }
  }
}

TEST_F(OnnxRuntimes, SayWhatIsWrong) {
  std::ofstream(model()) << "not a network";
  EXPECT_THAT(error_with("onnxruntime"),
              AllOf(HasSubstr("s.yaml:1: model"), HasSubstr("ONNX Runtime cannot read it"),
                    Not(HasSubstr("OpenCV"))));
  EXPECT_THAT(error_with("auto"), AllOf(HasSubstr("OpenCV's DNN module cannot read it"),
                                        HasSubstr("ONNX Runtime cannot read it")));
  testing::OnnxModel::write(model(), {{1, 0, 0, 0}}, {0}, width, height);
  EXPECT_THAT(error_with("onnxruntime"), HasSubstr("does not take a picture of 32x24 pixels"));
}

TEST_F(NetworkRuntimes, OnlyTheChosenOneIsTried) {
  std::ofstream(model()) << "not a network";
  EXPECT_THAT(error_with("opencv"), AllOf(HasSubstr("OpenCV's DNN module cannot read it"),
                                          Not(HasSubstr("ONNX Runtime"))));
  if (has_onnx_runtime()) return;
  EXPECT_THAT(error_with("auto"), HasSubstr("ONNX Runtime, which is tried next, is not installed"));
  EXPECT_THAT(error_with("onnxruntime"),
              AllOf(HasSubstr("s.yaml:2: runtime"), HasSubstr("libonnxruntime.so was not found")));
}

}  // namespace
}  // namespace diminish
