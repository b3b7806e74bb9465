#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

namespace diminish {

/// A loaded ONNX network. Used by one thread at a time.
class NetworkRuntime {
 public:
  virtual ~NetworkRuntime() = default;

  /// The network's first output. input: continuous 32-bit floats, in the shape that the network
  /// wants. The output is valid until the next call. Throws Error: in one line, without the file.
  virtual cv::Mat run(const cv::Mat& input) = 0;
};

/// By OpenCV's DNN module, on the CPU. Throws Error.
std::unique_ptr<NetworkRuntime> opencv_runtime(const std::filesystem::path& model);

/// By ONNX Runtime, on the CPU, in the caller's thread. Throws Error, also if it is not installed.
std::unique_ptr<NetworkRuntime> onnx_runtime(const std::filesystem::path& model);

/// Whether libonnxruntime.so can be loaded: it is looked for once, where the system's linker looks.
bool has_onnx_runtime();

}  // namespace diminish
