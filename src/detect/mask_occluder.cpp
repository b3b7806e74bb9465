#include <algorithm>

#include "diminish/occluder_detector.h"
#include "source/mask_folders.h"

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
  MaskOccluder(const OccluderSpec& spec, const Rig& rig) : name_(spec.name) {
    parse_mask_folders(spec, rig);
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

const bool registered =
    Registry<OccluderDetector>::add("mask", [](const OccluderSpec& spec, const Rig& rig) {
      return std::make_unique<MaskOccluder>(spec, rig);
    });

}  // namespace
}  // namespace diminish
