#include <algorithm>
#include <vector>

#include "core/tasks.h"
#include "detect/segment/depth_outline.h"
#include "detect/segment/segmentation.h"
#include "diminish/occluder_detector.h"
#include "diminish/occluder_settings.h"

namespace diminish {
namespace {

/// What a segmentation network finds, in all cameras' pictures, each for itself.
class OnnxOccluder : public OccluderDetector {
 public:
  OnnxOccluder(const OccluderSpec& spec, const Rig& rig) : name_(spec.name) {
    const auto& settings = settings_of<OnnxSettings>(spec);
    needs_order_ = settings.every > 1 || settings.steady > 0;
    const auto add = [&](const Intrinsics& camera) {
      networks_->push_back(std::make_unique<Segmentation>(settings, spec.place,
                                                          cv::Size(camera.width, camera.height)));
    };
    add(rig.color);
    for (const RgbdCamera& camera : rig.rgbd) {
      add(camera.color);
      outlines_.emplace_back(camera);
      in_rgbd_.emplace_back(camera.color.width, camera.color.height);
      // Half a pixel of the network's input on either side, and as much again for its blur.
      error_px_.push_back(static_cast<float>(camera.color.width) /
                          static_cast<float>(settings.width));
      measures_depth_.push_back(camera.measures_depth ? 1 : 0);
    }
  }

  bool needs_order() const override { return needs_order_; }
  void share(OccluderDetector& other) override {
    if (needs_order_) networks_ = dynamic_cast<OnnxOccluder&>(other).networks_;
  }

  OccluderReport detect(const Observation& observation, OcclusionMasks& masks) override {
    const FrameSet& frame = observation.frame;
    OccluderReport report;
    report.name = name_;
    found_.assign(networks_->size(), 0);
    for_tasks(networks_->size(), [&](std::size_t i) {
      Segmentation& network = *(*networks_)[i];
      bool any = false;
      if (i == 0) {
        any = !frame.color.empty() && network.segment(frame.color, frame.stamp_s, masks.color);
      } else if (frame.rgbd[i - 1].has_picture()) {
        const RgbdFrame& rgbd = frame.rgbd[i - 1];
        any = network.segment(rgbd.color, frame.stamp_s, in_rgbd_[i - 1]);
        if (any) add_rgbd(i - 1, rgbd, observation.options, masks.rgbd_color[i - 1]);
      }
      found_[i] = any ? 1 : 0;
    });
    report.in_color = found_[0] != 0;
    report.in_rgbd.assign(found_.begin() + 1, found_.end());
    return report;
  }

 private:
  /// Adds what was found to the masks, its outline by the depth; clears it for the next frame.
  void add_rgbd(std::size_t k, const RgbdFrame& rgbd, const Options& options, Mask& mask) {
    Mask& found = in_rgbd_[k];
    if (measures_depth_[k] && rgbd.available()) {
      outlines_[k].refine(rgbd.depth, error_px_[k],
                          static_cast<float>(options.discontinuity_threshold_m), found);
    }
    for (int y = 0; y < mask.height(); ++y) {
      std::uint8_t* const row = found.row(y);
      std::uint8_t* const into = mask.row(y);
      for (int x = 0; x < mask.width(); ++x) into[x] |= row[x];
      std::fill_n(row, mask.width(), std::uint8_t{0});
    }
  }

  using Networks = std::vector<std::unique_ptr<Segmentation>>;

  std::string name_;
  bool needs_order_ = false;
  /// Of the colour camera, and of each RGB-D camera.
  std::shared_ptr<Networks> networks_ = std::make_shared<Networks>();
  std::vector<DepthOutline> outlines_;  ///< of each RGB-D camera, as are the next three
  std::vector<float> error_px_;
  std::vector<char> measures_depth_;
  std::vector<Mask> in_rgbd_;
  std::vector<char> found_;  ///< by image; not std::vector<bool>, whose elements share bytes
};

std::shared_ptr<const OccluderSettings> read_onnx_settings(const Config& place) {
  place.expect_keys({"name", "detector", "model", "runtime", "size", "scale", "mean", "channels",
                     "layout", "classes", "threshold", "every", "steady"});
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
  if_there("runtime", [&](const Config& value) {
    using Runtime = OnnxSettings::Runtime;
    const std::string chosen = value.choice({"auto", "opencv", "onnxruntime"});
    settings->runtime = chosen == "opencv"        ? Runtime::opencv
                        : chosen == "onnxruntime" ? Runtime::onnxruntime
                                                  : Runtime::automatic;
  });
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
  if_there("every", [&](const Config& value) {
    settings->every = value.integer(1, OnnxSettings::greatest_every);
  });
  if_there("steady", [&](const Config& value) { settings->steady = value.number(); });
  return settings;
}

const bool onnx_occluder_registered = Registry<OccluderDetector>::add(
    "onnx", {.read = read_onnx_settings, .make = [](const OccluderSpec& spec, const Rig& rig) {
               return std::make_unique<OnnxOccluder>(spec, rig);
             }});

}  // namespace
}  // namespace diminish
