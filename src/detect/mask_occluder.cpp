#include <algorithm>

#include "diminish/occluder_detector.h"
#include "diminish/occluder_settings.h"

namespace diminish {
namespace {

/// Adds a given mask; returns whether it has pixels.
bool add(const Mask& given, Mask& mask) {
  if (given.width() != mask.width() || given.height() != mask.height()) return false;
  bool any = false;
  std::transform(given.begin(), given.end(), mask.begin(), mask.begin(),
                 [&any](std::uint8_t from, std::uint8_t to) -> std::uint8_t {
                   any = any || from != 0;
                   return from != 0 ? 255 : to;
                 });
  return any;
}

/// An object whose masks another program made; the frame source reads them.
class MaskOccluder : public OccluderDetector {
 public:
  explicit MaskOccluder(const OccluderSpec& spec) : name_(spec.name) {
    settings_of<MaskSettings>(spec);
  }

  OccluderReport detect(const Observation& observation, OcclusionMasks& masks) override {
    const FrameSet& frame = observation.frame;
    OccluderReport report;
    report.name = name_;
    report.in_rgbd.assign(frame.rgbd.size(), false);
    const auto given = std::find_if(frame.masks.begin(), frame.masks.end(),
                                    [this](const auto& mask) { return mask.occluder == name_; });
    if (given == frame.masks.end() || given->color.empty()) {
      report.message = name_ + ": no mask for the colour image of this frame";
    }
    if (given == frame.masks.end()) return report;
    report.in_color = add(given->color, masks.color);
    for (std::size_t k = 0; k < std::min(frame.rgbd.size(), given->rgbd.size()); ++k) {
      report.in_rgbd[k] = frame.rgbd[k].available() && add(given->rgbd[k], masks.rgbd_color[k]);
    }
    return report;
  }

 private:
  std::string name_;
};

/// Which keys are cameras' names, the rig tells (MaskSettings::check).
std::shared_ptr<const OccluderSettings> read_mask_settings(const Config& place) {
  auto settings = std::make_shared<MaskSettings>();
  settings->color = place.at("color").path();
  for (const std::string& key : place.keys()) {
    if (key == "name" || key == "detector" || key == "color") continue;
    settings->rgbd[key] = place.at(key).path();
  }
  return settings;
}

const bool mask_occluder_registered = Registry<OccluderDetector>::add(
    "mask", {.read = read_mask_settings, .make = [](const OccluderSpec& spec, const Rig&) {
               return std::make_unique<MaskOccluder>(spec);
             }});

}  // namespace
}  // namespace diminish
