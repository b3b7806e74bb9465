#include "memory/recollection.h"

#include <algorithm>

#include "geometry/point_rows.h"
#include "memory/keyframe_preparation.h"

namespace diminish {
namespace {

/// Joins neighbours in depth if the gap between them in the picture is narrow: a threshold that
/// grows with the square of the depth.
void join_narrow_gaps(double focal_px, double baseline_m, Options& options) {
  constexpr double widest_px = 3;
  constexpr double reach_m = 0.01;
  constexpr double least_baseline_m = 1e-4;
  options.discontinuity_reach_m = reach_m;
  options.discontinuity_threshold_m =
      widest_px * reach_m * reach_m / (focal_px * std::max(baseline_m, least_baseline_m));
}

}  // namespace

Recollection::Recollection(const Rig& rig, const KeyframeGrid& grid)
    : rig_(keyframe_rig(rig, grid)),
      grid_(grid),
      color_(Lens(rig.color)),
      far_(rig.color, {.last_step = 5 * PoseRefinement::usual_last_step,
                       .extrapolates = true,
                       .coarser = PoseRefinement::usual_coarser + 1,
                       .reach = 3}),
      coarse_(rig.color, {.last_step = 5 * PoseRefinement::usual_last_step, .extrapolates = true}),
      fine_(rig.color, {.small_width = 2 * PoseRefinement::usual_width,
                        .last_step = 2 * PoseRefinement::usual_last_step,
                        .extrapolates = true}),
      witness_(rig, grid),
      drawer_(Registry<Reconstructor>::get("cpu")(rig_)),
      depth_(1),
      masks_(keyframe_masks(rig, grid)),
      edges_(rig.color, grid) {}

void Recollection::begin(const KeyframeStore::Choice& choice, const RecallInputs& inputs) {
  keyframe_ = choice.keyframe;
  part_ = choice.part;
  const Keyframe& keyframe = *keyframe_;
  frame_.color = inputs.frame.color.view();
  show(keyframe, frame_);
  poses_.color_from_depth.assign(1, RigidTransform());
  samples_.surfaces.clear();
  for (const SceneSample& sample : keyframe.samples) {
    // It may have been removed since.
    const int x = static_cast<int>(sample.texture.x()) / grid_.step();
    const int y = static_cast<int>(sample.texture.y()) / grid_.step();
    if (keyframe.depth(x, y) != 0) samples_.surfaces.push_back(sample);
  }
  move(*inputs.poses.color_from_world * keyframe.color_from_world.inverse());
}

void Recollection::move(const std::optional<RigidTransform>& motion) {
  if (motion) coarse_.apply(*motion, poses_, samples_);
}

std::optional<RigidTransform> Recollection::align(const RecallInputs& inputs) {
  PoseRefinement& refinement = keyframe_->is_users() ? coarse_ : far_;
  std::optional<RigidTransform> motion = refinement.refine(frame_, inputs.masks.color, samples_);
  move(motion);
  return motion;
}

void Recollection::prepare(const RecallInputs& inputs, const std::vector<Testimony>& now) {
  const Keyframe& keyframe = *keyframe_;
  move(fine_.refine(frame_, inputs.masks.color, samples_));
  // A gain and an offset do not need all.
  constexpr std::size_t samples_apart = 3;
  some_.clear();
  for (std::size_t i = 0; i < samples_.surfaces.size(); i += samples_apart) {
    some_.push_back(samples_.surfaces[i]);
  }
  color_maps_.fit(inputs.frame.color, inputs.masks.color, some_, ColorMapModel::affine);
  find_levels(color_maps_.by_source()[1]);
  witness_.judge({keyframe, *poses_.color_from_depth[0], now, inputs.poses, part_}, depth_[0],
                 gone_);
  find_beside(inputs);
}

/// The map is affine: a gain and an offset for each channel.
void Recollection::find_levels(const ColorMap& map) {
  for (std::size_t c = 0; c < levels_.size(); ++c) {
    const auto channel = static_cast<Eigen::Index>(c);
    for (std::size_t level = 0; level < levels_[c].size(); ++level) {
      levels_[c][level] =
          map.matrix(channel, channel) * static_cast<float>(level) + map.offset[channel];
    }
  }
}

void Recollection::find_beside(const RecallInputs& inputs) {
  beside_.clear();
  add_beside(inputs, witness_.part(), 1, intersect(grow(part_, TiledRegion::tile), inputs.region));
  if (beside_.size() >= fewest_beside) return;
  beside_.clear();
  constexpr int rows_apart = 4;
  add_beside(inputs, depth_[0].bounds(), rows_apart, inputs.region);
}

void Recollection::add_beside(const RecallInputs& inputs, const Rect& places, int rows_apart,
                              const Rect& part) {
  const RayTable& rays = grid_.rays();
  const PointView view{FloatTransform(*poses_.color_from_depth[0]), color_, part, rig_.color.width};
  float depth_m[KeyframeGrid::most_columns];
  std::int32_t pixels[KeyframeGrid::most_columns];
  for (int y = places.y; y < places.bottom(); y += rows_apart) {
    const std::uint16_t* const depth = depth_[0].row(y) + places.x;
    for (int i = 0; i < places.width; ++i) depth_m[i] = KeyframeGrid::depth_m(depth[i]);
    find_pixels({rays.x(y) + places.x, rays.y(y) + places.x, depth_m, places.width}, view, pixels,
                depth_m);
    for (int i = 0; i < places.width; ++i) {
      if (pixels[i] < 0 || inputs.masks.color.data()[pixels[i]] != 0) continue;
      const int row = pixels[i] / rig_.color.width;
      const int column = pixels[i] - row * rig_.color.width;
      if (!inputs.region.keeps(column, row)) continue;
      beside_.push_back(
          {column, row, keyframe_->picture((places.x + i) * grid_.step(), y * grid_.step())});
    }
  }
}

void Recollection::draw(const RecallInputs& inputs) {
  Options options = inputs.options;
  join_narrow_gaps(rig_.color.fx, baseline_m(), options);
  drawer_->reconstruct(frame_, depth_, poses_, masks_, part_, options, drawn_);
  edges_.close(
      {keyframe_->picture, depth_[0], FloatTransform(poses_.color_from_depth[0]->inverse())},
      inputs.masks.color, part_, drawn_);
}

}  // namespace diminish
