#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "core/mat.h"
#include "core/tasks.h"
#include "diminish/occluder_detector.h"
#include "diminish/occluder_settings.h"

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

/// A segmentation network. Used by one thread at a time.
class Network {
 public:
  /// Tries it. Throws Error that names the file.
  Network(const OnnxSettings& settings, const Config& place) : settings_(settings) {
    const Quiet quiet;
    try {
      net_ = cv::dnn::readNetFromONNX(settings.model.string());
    } catch (const cv::Exception& error) {
      place.find("model").fail("cannot be read: " + settings.model.string() + ": " +
                               first_line(error) +
                               "; expected an ONNX file that OpenCV's DNN "
                               "module supports");
    }
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    cv::Mat output;
    try {
      output = forward(cv::Mat(settings.height, settings.width, CV_8UC3, cv::Scalar()));
    } catch (const cv::Exception& error) {
      place.find("model").fail(fmt::format("{}: does not take a picture of {}x{} pixels: {}",
                                           settings.model.string(), settings.width, settings.height,
                                           first_line(error)));
    }
    const std::string wrong = shape_error(output);
    if (!wrong.empty()) place.find("model").fail(settings.model.string() + ": " + wrong);
  }

  /// Sets the object's pixels in the mask; returns whether there are any.
  bool segment(ImageView<Bgr> picture, Mask& mask) {
    const cv::Mat output = forward(as_mat(picture));
    const Shape shape = shape_of(output);
    find_margin(output, shape);
    cv::resize(margin_, enlarged_, cv::Size(picture.width(), picture.height()), 0, 0,
               cv::INTER_LINEAR);
    bool any = false;
    for (int y = 0; y < mask.height(); ++y) {
      const auto* const margin = enlarged_.ptr<float>(y);
      std::uint8_t* const row = mask.row(y);
      for (int x = 0; x < mask.width(); ++x) {
        if (!(margin[x] > 0)) continue;
        row[x] = 255;
        any = true;
      }
    }
    return any;
  }

 private:
  /// Of the output.
  struct Shape {
    int channels = 0, height = 0, width = 0;
  };

  static std::string first_line(const cv::Exception& error) {
    return error.err.substr(0, error.err.find('\n'));
  }

  cv::Mat forward(const cv::Mat& picture) {
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
    net_.setInput(input_);
    return net_.forward();
  }

  /// All 0 if it is no picture.
  Shape shape_of(const cv::Mat& output) const {
    const auto size = [&](int i) { return output.size[i]; };
    if (output.type() != CV_32F) return {};
    if (output.dims == 2) return {1, size(0), size(1)};
    if (output.dims == 3 && size(0) == 1) return {1, size(1), size(2)};
    if (output.dims != 4 || size(0) != 1) return {};
    if (settings_.layout == OnnxSettings::Layout::nhwc) return {size(3), size(1), size(2)};
    return {size(1), size(2), size(3)};
  }

  std::string shape_error(const cv::Mat& output) const {
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
      return fmt::format("has {} classes, from 0 on; expected a class {}", shape.channels,
                         greatest);
    }
    return {};
  }

  /// By how much the object wins in each pixel of the output.
  void find_margin(const cv::Mat& output, const Shape& shape) {
    const auto* const values = output.ptr<float>();
    const bool channels_last = settings_.layout == OnnxSettings::Layout::nhwc;
    const std::ptrdiff_t pixels = std::ptrdiff_t{shape.height} * shape.width;
    margin_.create(shape.height, shape.width, CV_32F);
    auto* const margin = margin_.ptr<float>();
    for (std::ptrdiff_t i = 0; i < pixels; ++i) {
      if (shape.channels == 1) {
        margin[i] = values[i] - static_cast<float>(settings_.threshold);
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
      margin[i] = std::min(object - other, std::numeric_limits<float>::max());
    }
  }

  OnnxSettings settings_;
  cv::dnn::Net net_;
  cv::Mat input_, margin_, enlarged_;
};

/// What a segmentation network finds, in all cameras' pictures, each for itself.
class OnnxOccluder : public OccluderDetector {
 public:
  OnnxOccluder(const OccluderSpec& spec, const Rig& rig) : name_(spec.name) {
    const auto& settings = settings_of<OnnxSettings>(spec);
    for (std::size_t i = 0; i <= rig.rgbd.size(); ++i) networks_.emplace_back(settings, spec.place);
  }

  OccluderReport detect(const Observation& observation, OcclusionMasks& masks) override {
    const FrameSet& frame = observation.frame;
    OccluderReport report;
    report.name = name_;
    found_.assign(networks_.size(), 0);
    for_tasks(networks_.size(), [&](std::size_t i) {
      if (i == 0) {
        found_[i] = !frame.color.empty() && networks_[i].segment(frame.color, masks.color) ? 1 : 0;
      } else if (frame.rgbd[i - 1].available()) {
        found_[i] = networks_[i].segment(frame.rgbd[i - 1].color, masks.rgbd_color[i - 1]) ? 1 : 0;
      }
    });
    report.in_color = found_[0] != 0;
    report.in_rgbd.assign(found_.begin() + 1, found_.end());
    return report;
  }

 private:
  std::string name_;
  std::vector<Network> networks_;  ///< of the colour camera, and of each RGB-D camera
  std::vector<char> found_;        ///< by image; not std::vector<bool>, whose elements share bytes
};

std::shared_ptr<const OccluderSettings> read_settings(const Config& place) {
  place.expect_keys({"name", "detector", "model", "size", "scale", "mean", "channels", "layout",
                     "classes", "threshold"});
  auto settings = std::make_shared<OnnxSettings>();
  settings->model = place.at("model").path();
  const std::vector<double> size = place.at("size").numbers(2);
  constexpr double most = 1e6;
  settings->width = static_cast<int>(std::clamp(size[0], 0., most));
  settings->height = static_cast<int>(std::clamp(size[1], 0., most));
  const auto if_there = [&](const char* key, const auto& read) {
    const Config value = place.find(key);
    if (value.exists()) read(value);
  };
  if_there("scale", [&](const Config& value) { settings->scale = value.number(); });
  if_there("mean", [&](const Config& value) { settings->mean = value.vector3(); });
  if_there("channels", [&](const Config& value) {
    settings->is_bgr = value.choice({"rgb", "bgr"}) == "bgr";
  });
  if_there("layout", [&](const Config& value) {
    const bool is_nhwc = value.choice({"nchw", "nhwc"}) == "nhwc";
    settings->layout = is_nhwc ? OnnxSettings::Layout::nhwc : OnnxSettings::Layout::nchw;
  });
  if_there("classes", [&](const Config& value) {
    settings->classes.clear();
    constexpr int most_classes = 100000;
    for (const Config& item : value.items()) {
      settings->classes.push_back(item.integer(0, most_classes));
    }
  });
  if_there("threshold", [&](const Config& value) { settings->threshold = value.number(); });
  return settings;
}

const bool registered = Registry<OccluderDetector>::add(
    "onnx", {.read = read_settings, .make = [](const OccluderSpec& spec, const Rig& rig) {
               return std::make_unique<OnnxOccluder>(spec, rig);
             }});

}  // namespace
}  // namespace diminish
