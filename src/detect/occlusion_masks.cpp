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
  drawings_.resize(1 + 2 * rig.rgbd.size());
  processor_ = Registry<MaskDrawer>::get("cpu")();
}

bool OccluderStage::needs_markers() const {
  return std::any_of(detectors_.begin(), detectors_.end(),
                     [](const auto& detector) { return detector->needs_markers(); });
}

void OccluderStage::draw_by(const std::string& drawer) {
  if (drawer == drawer_name_) return;
  drawer_name_ = drawer;
  drawer_.reset();
}

void OccluderStage::detect(const Observation& observation, OcclusionMasks& masks,
                           std::vector<OccluderReport>& reports) {
  clear(masks);
  outlines_.clear(rig_.rgbd.size());
  is_blank_ = true;
  reports.clear();
  const std::vector<std::string> kept = kept_objects(observation.options);
  for (std::size_t i = 0; i < detectors_.size(); ++i) {
    if (std::find(kept.begin(), kept.end(), names_[i]) != kept.end()) {
      reports.push_back(
          {.name = names_[i], .in_rgbd = std::vector<bool>(rig_.rgbd.size(), false), .kept = true});
    } else if (auto* const shape = dynamic_cast<ShapeDetector*>(detectors_[i].get())) {
      reports.push_back(shape->outline(observation, static_cast<std::uint32_t>(i), outlines_));
    } else {
      reports.push_back(detectors_[i]->detect(observation, masks));
      is_blank_ = false;
    }
  }
  draw(observation.options, masks, reports);
}

/// What is outlined, and the margins.
void OccluderStage::draw(const Options& options, OcclusionMasks& masks,
                         std::vector<OccluderReport>& reports) {
  double deviation_px = 0;
  for (const OccluderReport& report : reports) {
    deviation_px = std::max(deviation_px, report.deviation_px);
  }
  list_drawings(options, deviation_px, masks);
  draw_by_chosen();
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const auto covers = [&](std::size_t image) { return drawings_[image].covers[i] != 0; };
    if (covers(0)) reports[i].in_color = true;
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      if (covers(1 + 2 * k) || covers(2 + 2 * k)) reports[i].in_rgbd[k] = true;
    }
  }
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

void OccluderStage::list_drawings(const Options& options, double deviation_px,
                                  OcclusionMasks& masks) {
  // A marker that faces the camera leaves its own lean open; so much it does not matter.
  constexpr double most_px = 10;
  // Half the margin is for blur, half for what is usual.
  const double usual_px = options.mask_margin_px / 2.0;
  const double wanted_px =
      options.margin_deviations > 0 ? options.margin_deviations * deviation_px : 0;
  const auto more_px = static_cast<int>(std::lrint(std::clamp(wanted_px - usual_px, 0.0, most_px)));
  const auto list = [&](std::size_t image, const Polygons& polygons, int margin_px, Mask& mask) {
    MaskDrawing& drawing = drawings_[image];
    drawing.polygons = &polygons;
    drawing.margin_px = margin_px;
    drawing.is_blank = is_blank_;
    drawing.mask = &mask;
    drawing.covers.assign(detectors_.size(), 0);
  };
  list(0, outlines_.color, options.mask_margin_px + more_px, masks.color);
  const int margin_px = options.rgbd_mask_margin_px + more_px;
  for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
    list(1 + 2 * k, outlines_.rgbd_color[k], margin_px, masks.rgbd_color[k]);
    list(2 + 2 * k, outlines_.rgbd_depth[k], depth_margin_px(rig_.rgbd[k], margin_px),
         masks.rgbd_depth[k]);
  }
}

void OccluderStage::draw_by_chosen() {
  message_.clear();
  try {
    if (!drawer_) drawer_ = Registry<MaskDrawer>::get(drawer_name_)();
    drawer_->draw(drawings_);
  } catch (const Error& error) {
    drawer_.reset();
    message_ = std::string(error.what()) + "; masks were drawn by the processor instead";
    processor_->draw(drawings_);
  }
}

}  // namespace diminish
