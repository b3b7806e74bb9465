#include "detect/segment/segmentation_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <opencv2/dnn.hpp>

#include "core/mat.h"
#include "diminish/error.h"

namespace diminish {

SegmentationNetwork::SegmentationNetwork(const OnnxSettings& settings, const Config& place)
    : settings_(settings) {
  using Runtime = OnnxSettings::Runtime;
  const auto fail = [&](const std::string& why) {
    place.find("model").fail(settings.model.string() + ": " + why);
  };
  if (settings.runtime == Runtime::onnxruntime && !has_onnx_runtime()) {
    place.find("runtime").fail(
        "onnxruntime: libonnxruntime.so was not found; install ONNX Runtime where the linker looks "
        "(LD_LIBRARY_PATH), or take opencv");
  }
  std::string wrong;
  if (settings.runtime != Runtime::onnxruntime) {
    wrong = start(opencv_runtime);
    if (!wrong.empty()) wrong = "OpenCV's DNN module " + wrong;
  }
  const bool is_next = settings.runtime == Runtime::automatic && !wrong.empty();
  if (is_next && !has_onnx_runtime())
    wrong += "; ONNX Runtime, which is tried next, is not installed";
  if (settings.runtime == Runtime::onnxruntime || (is_next && has_onnx_runtime())) {
    const std::string also_wrong = start(onnx_runtime);
    if (!also_wrong.empty()) {
      fail(wrong + (wrong.empty() ? "" : "; ") + "ONNX Runtime " + also_wrong);
    }
    wrong.clear();
  }
  if (!wrong.empty()) fail(wrong);
  wrong = shape_error(tried_);
  if (!wrong.empty()) fail(wrong);
}

std::string SegmentationNetwork::start(MakeRuntime& make) {
  try {
    runtime_ = make(settings_.model);
  } catch (const Error& error) {
    return fmt::format("cannot read it: {}; expected an ONNX file", error.what());
  }
  try {
    tried_ = forward(cv::Mat(settings_.height, settings_.width, CV_8UC3, cv::Scalar()));
  } catch (const Error& error) {
    return fmt::format("does not take a picture of {}x{} pixels: {}", settings_.width,
                       settings_.height, error.what());
  }
  return {};
}

void SegmentationNetwork::find_margin(ImageView<Bgr> picture, cv::Mat& margin) {
  cv::Mat output;
  try {
    output = forward(as_mat(picture));
  } catch (const Error& error) {
    throw Error(settings_.model.string() + ": " + error.what());
  }
  const Shape shape = shape_of(output);
  const auto* const values = output.ptr<float>();
  const bool channels_last = settings_.layout == OnnxSettings::Layout::nhwc;
  const std::ptrdiff_t pixels = std::ptrdiff_t{shape.height} * shape.width;
  margin.create(shape.height, shape.width, CV_32F);
  auto* const found = margin.ptr<float>();
  for (std::ptrdiff_t i = 0; i < pixels; ++i) {
    if (shape.channels == 1) {
      found[i] = values[i] - static_cast<float>(settings_.threshold);
      continue;
    }
    float object = -std::numeric_limits<float>::infinity();
    float other = object;
    for (int c = 0; c < shape.channels; ++c) {
      const float value = values[channels_last ? i * shape.channels + c : c * pixels + i];
      const bool is_object = std::find(settings_.classes.begin(), settings_.classes.end(), c) !=
                             settings_.classes.end();
      (is_object ? object : other) = std::max(is_object ? object : other, value);
    }
    // All classes may be the object's.
    found[i] = std::min(object - other, std::numeric_limits<float>::max());
  }
}

cv::Mat SegmentationNetwork::forward(const cv::Mat& picture) {
  const Eigen::Vector3d& mean = settings_.mean;
  const cv::Scalar in_order = settings_.is_bgr ? cv::Scalar(mean.z(), mean.y(), mean.x())
                                               : cv::Scalar(mean.x(), mean.y(), mean.z());
  cv::dnn::blobFromImage(picture, input_, settings_.scale,
                         cv::Size(settings_.width, settings_.height), in_order, !settings_.is_bgr,
                         false, CV_32F);
  if (settings_.layout == OnnxSettings::Layout::nhwc) {
    cv::Mat channels_last;
    cv::transposeND(input_, {0, 2, 3, 1}, channels_last);
    input_ = channels_last;
  }
  return runtime_->run(input_);
}

SegmentationNetwork::Shape SegmentationNetwork::shape_of(const cv::Mat& output) const {
  const auto size = [&](int i) { return output.size[i]; };
  if (output.type() != CV_32F) return {};
  if (output.dims == 2) return {1, size(0), size(1)};
  if (output.dims == 3 && size(0) == 1) return {1, size(1), size(2)};
  if (output.dims != 4 || size(0) != 1) return {};
  if (settings_.layout == OnnxSettings::Layout::nhwc) return {size(3), size(1), size(2)};
  return {size(1), size(2), size(3)};
}

std::string SegmentationNetwork::shape_error(const cv::Mat& output) const {
  const Shape shape = shape_of(output);
  if (shape.channels == 0) {
    std::string sizes;
    for (int i = 0; i < output.dims; ++i) {
      sizes += (i > 0 ? "x" : "") + std::to_string(output.size[i]);
    }
    return "expected an output of 1 x classes x rows x columns, got " + sizes;
  }
  const int greatest = *std::max_element(settings_.classes.begin(), settings_.classes.end());
  if (shape.channels > 1 && greatest >= shape.channels) {
    return fmt::format("has {} classes, from 0 on; expected a class {}", shape.channels, greatest);
  }
  return {};
}

}  // namespace diminish
