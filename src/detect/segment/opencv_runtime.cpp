#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <optional>
#include <string>

#include "detect/segment/network_runtime.h"
#include "diminish/error.h"

namespace diminish {
namespace {

/// OpenCV would print what it throws.
class Quiet {
 public:
  Quiet() : before_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~Quiet() { cv::utils::logging::setLogLevel(before_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  cv::utils::logging::LogLevel before_;
};

Error first_line(const cv::Exception& error) {
  return Error(error.err.substr(0, error.err.find('\n')));
}

class OpencvRuntime final : public NetworkRuntime {
 public:
  explicit OpencvRuntime(const std::filesystem::path& model) {
    const Quiet quiet;
    try {
      net_ = cv::dnn::readNetFromONNX(model.string());
    } catch (const cv::Exception& error) {
      throw first_line(error);
    }
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  }

  cv::Mat run(const cv::Mat& input) override {
    // Only the first time, which no other thread sees: what is set is the process's.
    std::optional<Quiet> quiet;
    if (!has_run_) quiet.emplace();
    has_run_ = true;
    try {
      net_.setInput(input);
      return net_.forward();
    } catch (const cv::Exception& error) {
      throw first_line(error);
    }
  }

 private:
  cv::dnn::Net net_;
  bool has_run_ = false;
};

}  // namespace

std::unique_ptr<NetworkRuntime> opencv_runtime(const std::filesystem::path& model) {
  return std::make_unique<OpencvRuntime>(model);
}

}  // namespace diminish
