#include <cmath>
#include <vector>

#include "core/shrink.h"
#include "core/tasks.h"
#include "detect/difference/evidence_history.h"
#include "detect/difference/free_space.h"
#include "detect/difference/geodesic_fill.h"
#include "detect/difference/object_evidence.h"
#include "detect/difference/object_regions.h"
#include "detect/difference/rgbd_object.h"
#include "detect/difference/seen_layers.h"
#include "diminish/occluder_detector.h"
#include "diminish/occluder_settings.h"
#include "pose/pose_refinement.h"
#include "scene/background_planes.h"
#include "scene/color_maps.h"
#include "scene/scene_sampler.h"

namespace diminish {
namespace {

/// Whatever stands between the colour camera and what the RGB-D cameras see: nothing has to be
/// known of it. (Enomoto & Saito 2007 deduce occluders by comparing hand-held cameras, across
/// planes; here the RGB-D cameras tell the scene's shape, and where there is nothing.)
class DifferenceOccluder : public OccluderDetector {
 public:
  DifferenceOccluder(const OccluderSpec& spec, const Rig& rig)
      : name_(spec.name),
        rig_(rig),
        clearance_(static_cast<float>(settings_of<DifferenceSettings>(spec).clearance)),
        sampler_(rig),
        refinement_(rig.color, {.small_width = SeenLayersDrawer::usual_width / 2, .coarser = 1}),
        planes_(rig.color),
        drawer_(rig),
        free_space_(rig),
        evidence_(rig.color, drawer_.shrinkage()),
        history_(std::make_shared<EvidenceHistory>(rig.color, drawer_.shrinkage())) {
    no_masks_.color = Mask(rig.color.width, rig.color.height);
    for (const RgbdCamera& camera : rig.rgbd) {
      no_masks_.rgbd_color.emplace_back(camera.color.width, camera.color.height);
      no_masks_.rgbd_depth.emplace_back(camera.depth.width, camera.depth.height);
      rgbd_objects_.emplace_back();
    }
  }

  void share(OccluderDetector& other) override {
    history_ = dynamic_cast<DifferenceOccluder&>(other).history_;
  }

  OccluderReport detect(const Observation& observation, OcclusionMasks& masks) override {
    const FrameSet& frame = observation.frame;
    const Options& options = observation.options;
    OccluderReport report;
    report.name = name_;
    report.in_rgbd.assign(rig_.rgbd.size(), false);
    learn(observation);
    if (samples_.surfaces.empty()) {
      report.message = name_ + ": no RGB-D camera sees what the colour camera sees";
      return report;
    }
    const sdct::Threshold threshold(options.discontinuity_threshold_m,
                                    options.discontinuity_reach_m);
    drawer_.draw(frame, poses_, maps_.by_source(), threshold, layers_);
    free_space_.begin(frame, poses_);
    const Rect part = evidence_.find({picture_, layers_, free_space_, planes_.planes(), clearance_},
                                     evidence_shown_);
    if (options.memory != "off" && poses_.color_from_world) {
      history_->steady({picture_, layers_, evidence_, *poses_.color_from_world, frame.stamp_s},
                       part, evidence_shown_);
    }
    find_regions(part);
    report.in_color = add_enlarged(regions_, drawer_.shrinkage(), masks.color);
    if (!report.in_color) return report;
    in_rgbd_.assign(rig_.rgbd.size(), 0);
    for_tasks(rig_.rgbd.size(), [&](std::size_t k) {
      in_rgbd_[k] = rgbd_objects_[k].add(
          {regions_, evidence_shown_, layers_, evidence_, planes_.planes(), threshold},
          drawer_.vertices(k), drawer_.step(k), masks.rgbd_depth[k], masks.rgbd_color[k]);
    });
    report.in_rgbd.assign(in_rgbd_.begin(), in_rgbd_.end());
    return report;
  }

 private:
  /// What the comparison needs: the cameras' poses, how their colours relate, walls and tables.
  void learn(const Observation& observation) {
    const FrameSet& frame = observation.frame;
    poses_ = observation.poses;
    do_all(
        [&] {
          sampler_.sample(frame, poses_, no_masks_, samples_);
          if (!observation.options.refine_poses) return;
          const auto correction = refinement_.refine(frame, no_masks_.color, samples_);
          if (correction) refinement_.apply(*correction, poses_, samples_);
        },
        [&] {
          const Rect small = shrunk_bounds(frame.color, drawer_.shrinkage());
          picture_.resize(small.width, small.height);
          shrink(frame.color, drawer_.shrinkage(), small, scratch_, picture_);
        });
    do_all(
        [&] { maps_.fit(frame.color, no_masks_.color, samples_.surfaces, ColorMapModel::field); },
        [&] { planes_.find(rig_.color.bounds(), samples_.surfaces); });
  }

  /// part: of the small picture, that objects may be in.
  void find_regions(const Rect& part) {
    shown_ = evidence_shown_;
    fill_.fill(picture_, part, shown_);
    find_.find(evidence_shown_, shown_, regions_);
  }

  std::string name_;
  Rig rig_;
  float clearance_;
  OcclusionMasks no_masks_;
  SceneSampler sampler_;
  SceneSamples samples_;
  PoseRefinement refinement_;
  Poses poses_;
  ColorMaps maps_;
  BackgroundPlanes planes_;
  SeenLayersDrawer drawer_;
  SeenLayers layers_;
  FreeSpace free_space_;
  ObjectEvidence evidence_;
  std::shared_ptr<EvidenceHistory> history_;  ///< with --memory on, where frames come in order
  GeodesicFill fill_;
  ObjectRegions find_;
  std::vector<RgbdObject> rgbd_objects_;
  std::vector<char> in_rgbd_;  ///< not std::vector<bool>, whose elements share bytes
  std::vector<std::uint16_t> scratch_;
  Image<Bgr> picture_;
  Image<Shown> evidence_shown_, shown_;
  Mask regions_;
};

std::shared_ptr<const OccluderSettings> read_difference_settings(const Config& place) {
  place.expect_keys({"name", "detector", "clearance"});
  auto settings = std::make_shared<DifferenceSettings>();
  const Config clearance = place.find("clearance");
  if (clearance.exists()) settings->clearance = clearance.number();
  return settings;
}

const bool difference_occluder_registered = Registry<OccluderDetector>::add(
    "difference",
    {.read = read_difference_settings, .make = [](const OccluderSpec& spec, const Rig& rig) {
       return std::make_unique<DifferenceOccluder>(spec, rig);
     }});

}  // namespace
}  // namespace diminish
