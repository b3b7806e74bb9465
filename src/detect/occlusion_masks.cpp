#include "detect/occlusion_masks.h"

#include "core/tasks.h"

#include <algorithm>
#include <cmath>

namespace diminish {
namespace {

/// The depth sensor's margin that covers the same angle as `margin_px` does in the colour sensor.
int depth_margin_px(const RgbdCamera& camera, int margin_px) {
  return static_cast<int>(std::ceil(margin_px * camera.depth.fx / camera.color.fx));
}

}  // namespace

OccluderStage::OccluderStage(const Rig& rig, const Scene& scene) : rig_(rig) {
  using Detectors = Registry<OccluderDetector>;
  for (const OccluderSpec& spec : scene.occluders) {
    detectors_.push_back(Detectors::get(spec.detector).make(spec, rig));
    names_.push_back(spec.name);
    needs_order_ = needs_order_ || detectors_.back()->needs_order();
  }
  shared_->tracks.resize(detectors_.size());
  drawings_.resize(1 + 2 * rig.rgbd.size());
  masks_.color = Mask(rig.color.width, rig.color.height);
  for (const RgbdCamera& camera : rig.rgbd) {
    masks_.rgbd_color.emplace_back(camera.color.width, camera.color.height);
    masks_.rgbd_depth.emplace_back(camera.depth.width, camera.depth.height);
  }
  parts_.resize(drawings_.size());
  cpu_ = Registry<MaskDrawer>::get("cpu")();
}

bool OccluderStage::needs_markers() const {
  return std::any_of(detectors_.begin(), detectors_.end(),
                     [](const auto& detector) { return detector->needs_markers(); });
}

void OccluderStage::share(OccluderStage& other) {
  shared_ = other.shared_;
  for (std::size_t i = 0; i < detectors_.size(); ++i) detectors_[i]->share(*other.detectors_[i]);
}

void OccluderStage::draw_by(const std::string& drawer) {
  if (drawer == drawer_name_) return;
  drawer_name_ = drawer;
  drawer_.reset();
  attempts_ = {};
}

void OccluderStage::detect(const Observation& observation, std::vector<OccluderReport>& reports) {
  clear();
  outlines_.clear(rig_.rgbd.size(), detectors_.size());
  is_blank_ = true;
  reports.resize(detectors_.size());
  const std::vector<std::string> kept = kept_objects(observation.options);
  const bool remembers = observation.options.memory != "off";
  if (remembers || needs_order_) turn_.wait(shared_->turns);
  for (std::size_t i = 0; i < detectors_.size(); ++i) {
    OccluderReport& report = reports[i];
    auto* const shape = dynamic_cast<ShapeDetector*>(detectors_[i].get());
    const bool is_kept = std::find(kept.begin(), kept.end(), names_[i]) != kept.end();
    if (!is_kept && !shape) {
      detectors_[i]->detect_again(observation, masks_, report);
      is_blank_ = false;
      continue;
    }
    report.name = names_[i];
    report.in_color = false;
    report.in_rgbd.assign(rig_.rgbd.size(), false);
    report.kept = is_kept;
    report.message.clear();
    if (shape && !is_kept) {
      ObjectTrack* const track = remembers ? &shared_->tracks[i] : nullptr;
      shape->outline(observation, static_cast<std::uint32_t>(i), track, outlines_, report);
    }
  }
  end_turn();
  draw(observation.options, reports);
  objects_ = bounding_box(masks_.color, parts_[0]);
}

void OccluderStage::add(std::span<const Eigen::Vector2i> pixels) {
  for (const Eigen::Vector2i& pixel : pixels) {
    masks_.color(pixel.x(), pixel.y()) = 255;
    objects_ = join(objects_, {pixel.x(), pixel.y(), 1, 1});
  }
  parts_[0] = join(parts_[0], objects_);
}

/// What is outlined, and the margins.
void OccluderStage::draw(const Options& options, std::vector<OccluderReport>& reports) {
  list_drawings(options);
  draw_by_chosen();
  for (std::size_t i = 0; i < drawings_.size(); ++i) {
    const MaskDrawing& drawing = drawings_[i];
    parts_[i] = intersect(grow(drawing.part, drawing.margin_px), drawing.mask->bounds());
  }
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const auto covers = [&](std::size_t image) { return drawings_[image].covers[i] != 0; };
    if (covers(0)) reports[i].in_color = true;
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      if (covers(1 + 2 * k) || covers(2 + 2 * k)) reports[i].in_rgbd[k] = true;
    }
  }
}

/// Only where something may be set. Until the frame is done, that is anywhere.
void OccluderStage::clear() {
  for_tasks(parts_.size(), [&](std::size_t i) {
    Mask& mask = i == 0       ? masks_.color
                 : i % 2 == 1 ? masks_.rgbd_color[i / 2]
                              : masks_.rgbd_depth[i / 2 - 1];
    mask.fill(parts_[i], 0);
    parts_[i] = mask.bounds();
  });
}

void OccluderStage::list_drawings(const Options& options) {
  const auto list = [&](std::size_t image, const Polygons& polygons, int margin_px, Mask& mask) {
    MaskDrawing& drawing = drawings_[image];
    drawing.polygons = &polygons;
    drawing.margin_px = margin_px;
    drawing.is_blank = is_blank_;
    drawing.mask = &mask;
    drawing.covers.assign(detectors_.size(), 0);
  };
  list(0, outlines_.color, options.mask_margin_px, masks_.color);
  const int margin_px = options.rgbd_mask_margin_px;
  for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
    list(1 + 2 * k, outlines_.rgbd_color[k], margin_px, masks_.rgbd_color[k]);
    list(2 + 2 * k, outlines_.rgbd_depth[k], depth_margin_px(rig_.rgbd[k], margin_px),
         masks_.rgbd_depth[k]);
  }
  for_tasks(drawings_.size(), [&](std::size_t i) {
    MaskDrawing& drawing = drawings_[i];
    drawing.part = join(drawing.polygons->bounds(drawing.mask->bounds()),
                        is_blank_ ? Rect{} : bounding_box(*drawing.mask));
  });
}

void OccluderStage::draw_by_chosen() {
  message_.clear();
  if (attempts_.is_due() && try_drawer()) return;
  message_ = failure_ + "; masks were drawn by the CPU instead";
  cpu_->draw(drawings_);
}

bool OccluderStage::try_drawer() {
  try {
    if (!drawer_) drawer_ = Registry<MaskDrawer>::get(drawer_name_)();
    drawer_->draw(drawings_);
    attempts_.succeed();
    return true;
  } catch (const Error& error) {
    attempts_.fail();
    failure_ = error.what();
    drawer_.reset();
    return false;
  }
}

}  // namespace diminish
