#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "detect/segment/network_runtime.h"
#include "diminish/config.h"
#include "diminish/image.h"
#include "diminish/occluder_settings.h"

namespace diminish {

/// A segmentation network. Used by one thread at a time.
class SegmentationNetwork {
 public:
  /// Tries it. Throws Error that names the file.
  SegmentationNetwork(const OnnxSettings& settings, const Config& place);

  /// By how much the object wins over everything else, above 0 on the object: 32-bit floats, of the
  /// network's output's size. Throws Error.
  void find_margin(ImageView<Bgr> picture, cv::Mat& margin);

 private:
  /// Of the output.
  struct Shape {
    int channels = 0, height = 0, width = 0;
  };

  using MakeRuntime = std::unique_ptr<NetworkRuntime>(const std::filesystem::path& model);

  /// Loads and tries the network. Returns what is wrong; nothing if it runs.
  std::string start(MakeRuntime& make);
  cv::Mat forward(const cv::Mat& picture);
  /// All 0 if it is no picture.
  Shape shape_of(const cv::Mat& output) const;
  std::string shape_error(const cv::Mat& output) const;

  OnnxSettings settings_;
  std::unique_ptr<NetworkRuntime> runtime_;
  cv::Mat input_, tried_;
};

}  // namespace diminish
