#include "detect/occlusion_masks.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace diminish {
namespace {

void clear(const Intrinsics& intrinsics, Mask& mask) {
  mask.resize(intrinsics.width, intrinsics.height, 0);
}

/// The depth sensor's margin that covers the same angle as `margin_px` does in the colour sensor.
int depth_margin_px(const RgbdCamera& camera, int margin_px) {
  return static_cast<int>(std::ceil(margin_px * camera.depth.fx / camera.color.fx));
}

}  // namespace

OccluderStage::OccluderStage(const Rig& rig, const Scene& scene) : rig_(rig) {
  using Detectors = Registry<OccluderDetector>;
  for (const OccluderSpec& spec : scene.occluders) {
    if (!Detectors::contains(spec.detector)) {
      spec.config.at("detector")
          .fail("expected one of " + Detectors::known() + ", got '" + spec.detector + "'");
    }
    detectors_.push_back(Detectors::get(spec.detector)(spec, rig));
    names_.push_back(spec.name);
  }
  dilations_.resize(rig.rgbd.size() + 1);
}

bool OccluderStage::needs_markers() const {
  return std::any_of(detectors_.begin(), detectors_.end(),
                     [](const auto& detector) { return detector->needs_markers(); });
}

void OccluderStage::detect(const Observation& observation, OcclusionMasks& masks,
                           std::vector<OccluderReport>& reports) {
  clear(masks);
  reports.clear();
  const std::vector<std::string> kept = kept_objects(observation.options);
  for (std::size_t i = 0; i < detectors_.size(); ++i) {
    if (std::find(kept.begin(), kept.end(), names_[i]) == kept.end()) {
      reports.push_back(detectors_[i]->detect(observation, masks));
    } else {
      reports.push_back(
          {.name = names_[i], .in_rgbd = std::vector<bool>(rig_.rgbd.size(), false), .kept = true});
    }
  }
  double deviation_px = 0;
  for (const OccluderReport& report : reports) {
    deviation_px = std::max(deviation_px, report.deviation_px);
  }
  grow_by_margins(observation.options, deviation_px, masks);
}

void OccluderStage::clear(OcclusionMasks& masks) const {
  masks.rgbd_color.resize(rig_.rgbd.size());
  masks.rgbd_depth.resize(rig_.rgbd.size());
  oneapi::tbb::parallel_for(std::size_t{0}, rig_.rgbd.size() + 1, [&](std::size_t i) {
    if (i == 0) return diminish::clear(rig_.color, masks.color);
    diminish::clear(rig_.rgbd[i - 1].color, masks.rgbd_color[i - 1]);
    diminish::clear(rig_.rgbd[i - 1].depth, masks.rgbd_depth[i - 1]);
  });
}

void OccluderStage::grow_by_margins(const Options& options, double deviation_px,
                                    OcclusionMasks& masks) {
  // A marker that faces the camera leaves its own lean open; so much it does not matter.
  constexpr double most_px = 10;
  // Half the margin is for blur, half for what is usual.
  const double usual_px = options.mask_margin_px / 2.0;
  const double wanted_px =
      options.margin_deviations > 0 ? options.margin_deviations * deviation_px : 0;
  const auto more_px = static_cast<int>(std::lrint(std::clamp(wanted_px - usual_px, 0.0, most_px)));
  oneapi::tbb::parallel_for(std::size_t{0}, rig_.rgbd.size() + 1, [&](std::size_t i) {
    const auto grow_by = [&](int margin_px, Mask& mask) {
      if (margin_px > 0) dilations_[i].dilate(mask, margin_px);
    };
    if (i == 0) return grow_by(options.mask_margin_px + more_px, masks.color);
    const std::size_t k = i - 1;
    const int margin_px = options.rgbd_mask_margin_px + more_px;
    grow_by(margin_px, masks.rgbd_color[k]);
    grow_by(depth_margin_px(rig_.rgbd[k], margin_px), masks.rgbd_depth[k]);
  });
}

}  // namespace diminish
