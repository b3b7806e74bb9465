#include <algorithm>
#include <optional>
#include <vector>

#include "core/tasks.h"
#include "detect/color_blob/color_blob_finder.h"
#include "diminish/occluder_detector.h"
#include "diminish/occluder_settings.h"

namespace diminish {
namespace {

class ColorBlobDetector : public OccluderDetector {
 public:
  ColorBlobDetector(const OccluderSpec& spec, const Rig& rig) : name_(spec.name) {
    const auto& settings = settings_of<ColorBlobSettings>(spec);
    const bool round = settings.shape == ColorBlobSettings::Shape::circle;
    const auto make = [&](const std::string& camera) {
      return ColorBlobFinder(load_color_model(training_folder(settings.training, camera)), round);
    };
    color_.emplace(make("color"));
    for (const RgbdCamera& camera : rig.rgbd) rgbd_.push_back(make(camera.name));
  }

  OccluderReport detect(const Observation& observation, OcclusionMasks& masks) override {
    OccluderReport report;
    detect_again(observation, masks, report);
    return report;
  }

  void detect_again(const Observation& observation, OcclusionMasks& masks,
                    OccluderReport& report) override {
    const FrameSet& frame = observation.frame;
    const Options& options = observation.options;
    report.name = name_;
    report.kept = false;
    report.message.clear();
    // One image a core.
    found_.assign(rgbd_.size() + 1, 0);
    for_tasks(found_.size(), [&](std::size_t i) {
      if (i == 0) {
        found_[i] =
            !frame.color.empty() && color_->find(frame.color, options.blob_spread, masks.color);
      } else if (frame.rgbd[i - 1].available()) {
        found_[i] = rgbd_[i - 1].find(frame.rgbd[i - 1].color, options.blob_spread,
                                      masks.rgbd_color[i - 1]);
      }
    });
    report.in_color = found_[0] != 0;
    report.in_rgbd.resize(rgbd_.size());
    std::copy(found_.begin() + 1, found_.end(), report.in_rgbd.begin());
    const bool in_any = std::find(found_.begin(), found_.end(), char{1}) != found_.end();
    if (!in_any) report.message = name_ + ": no blob of its colour and shape in any camera";
  }

 private:
  std::string name_;
  std::optional<ColorBlobFinder> color_;
  std::vector<ColorBlobFinder> rgbd_;
  std::vector<char> found_;  ///< by image; not std::vector<bool>, whose elements share bytes
};

std::shared_ptr<const OccluderSettings> read_color_blob_settings(const Config& place) {
  place.expect_keys({"name", "detector", "training", "shape"});
  auto settings = std::make_shared<ColorBlobSettings>();
  settings->training = place.at("training").path();
  const Config shape = place.find("shape");
  if (shape.exists() && shape.choice({"circle", "any"}) == "circle") {
    settings->shape = ColorBlobSettings::Shape::circle;
  }
  return settings;
}

const bool color_blob_registered = Registry<OccluderDetector>::add(
    "color_blob",
    {.read = read_color_blob_settings, .make = [](const OccluderSpec& spec, const Rig& rig) {
       return std::make_unique<ColorBlobDetector>(spec, rig);
     }});

}  // namespace
}  // namespace diminish
