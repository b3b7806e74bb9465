#include "estimate/depth_estimation.h"

#include <algorithm>

namespace diminish {
namespace {

template <class Pixel>
void look_at(const InputImage<Pixel>& image, InputImage<Pixel>& view) {
  view = InputImage<Pixel>(image.view());
}

}  // namespace

bool DepthEstimation::is_needed() const {
  return std::any_of(rig_.rgbd.begin(), rig_.rgbd.end(),
                     [](const RgbdCamera& camera) { return !camera.measures_depth; });
}

bool DepthEstimation::needs_markers() const {
  return (is_needed() || rig_.rgbd.empty()) &&
         std::any_of(scene_.planes.begin(), scene_.planes.end(), [](const GivenPlane& plane) {
           return plane.from == GivenPlane::From::marker;
         });
}

void DepthEstimation::choose(const std::string& wanted) {
  std::string method = wanted;
  if (wanted == "auto") method = scene_.planes.empty() ? "stereo" : "planes";
  if (!is_needed() || method == method_) return;
  estimator_ = Registry<DepthEstimator>::get(method)(rig_, scene_);
  method_ = method;
}

const FrameSet& DepthEstimation::begin(const FrameSet& frame) {
  messages_.clear();
  if (!is_needed()) return frame;
  frame_.name = frame.name;
  frame_.index = frame.index;
  frame_.stamp_s = frame.stamp_s;
  look_at(frame.color, frame_.color);
  frame_.masks = frame.masks;
  frame_.faults = frame.faults;
  frame_.rgbd.resize(frame.rgbd.size());
  depths_.resize(frame.rgbd.size());
  for (std::size_t k = 0; k < frame.rgbd.size(); ++k) {
    const RgbdFrame& given = frame.rgbd[k];
    RgbdFrame& rgbd = frame_.rgbd[k];
    look_at(given.color, rgbd.color);
    rgbd.color_stamp_s = given.color_stamp_s;
    rgbd.depth_stamp_s = given.depth_stamp_s;
    rgbd.missing = given.missing;
    rgbd.remote = given.remote;
    if (rig_.rgbd[k].measures_depth) {
      look_at(given.depth, rgbd.depth);
      continue;
    }
    const Intrinsics& depth = rig_.rgbd[k].depth;
    depths_[k].resize(depth.width, depth.height, 0);
    rgbd.depth = InputImage<std::uint16_t>(ImageView<std::uint16_t>(depths_[k]));
  }
  return frame_;
}

void DepthEstimation::estimate(const Markers& markers, const Poses& poses,
                               const OcclusionMasks& masks, const Rect& drawn,
                               const Options& options) {
  if (!estimator_) return;
  wanted_.assign(rig_.rgbd.size(), false);
  bool is_any_wanted = false;
  for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
    wanted_[k] = !rig_.rgbd[k].measures_depth && frame_.rgbd[k].available() &&
                 poses.color_from_depth[k].has_value();
    is_any_wanted = is_any_wanted || wanted_[k];
  }
  if (!is_any_wanted) return;
  estimator_->estimate({frame_, markers, poses, masks, drawn, options, wanted_}, depths_,
                       messages_);
}

std::span<const InversePlane> DepthEstimation::own_planes(const Markers& markers,
                                                          const Poses& poses) {
  own_planes_.clear();
  if (!rig_.rgbd.empty()) return {};
  given_planes_.find(markers, poses, found_, messages_);
  for (GivenPlanes::Found& found : found_) own_planes_.push_back(std::move(found.plane));
  return own_planes_;
}

}  // namespace diminish
