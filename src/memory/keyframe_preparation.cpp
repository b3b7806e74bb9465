#include "memory/keyframe_preparation.h"

#include "core/rows.h"
#include "core/tasks.h"
#include "geometry/point_rows.h"

namespace diminish {
namespace {

/// Of a keyframe: as many as are used.
constexpr std::size_t most_samples = 2400;

}  // namespace

KeyframePreparation::KeyframePreparation(const Rig& rig, const KeyframeGrid& grid)
    : grid_(grid), sampler_(keyframe_rig(rig, grid)), masks_(keyframe_masks(rig, grid)) {
  for (const RgbdCamera& camera : rig.rgbd) testimony_grids_.emplace_back(camera.depth);
}

void KeyframePreparation::prepare(Keyframe& keyframe) {
  constexpr int step = KeyframeGrid::overview_step;
  const RayTable& overview = grid_.overview_rays();
  keyframe.overview_m.resize(overview.width(), overview.height());
  for (int y = 0; y < overview.height(); ++y) {
    for (int x = 0; x < overview.width(); ++x) {
      keyframe.overview_m(x, y) = KeyframeGrid::depth_m(keyframe.depth(x * step, y * step));
    }
  }
  keyframe.confirmed_s.resize(keyframe.depth.width(), keyframe.depth.height(), 0);
  keyframe.sights.resize(testimony_grids_.size());
  for_tasks(testimony_grids_.size() + 1, [&](std::size_t i) {
    i == testimony_grids_.size() ? find_samples(keyframe) : find_sights(keyframe, i);
  });
}

void KeyframePreparation::find_sights(Keyframe& keyframe, std::size_t camera) const {
  Image<Sight>& sights = keyframe.sights[camera];
  const Testimony& testimony = keyframe.testimonies[camera];
  const auto& color_from_depth = keyframe.color_from_depth[camera];
  if (!testimony.is_given || !color_from_depth) return sights.resize(0, 0);
  const int width = keyframe.depth.width();
  const int height = keyframe.depth.height();
  sights.resize(width, height);
  const TestimonyGrid& grid = testimony_grids_[camera];
  const PointView view{FloatTransform(color_from_depth->inverse()), grid.lens(), grid.bounds(),
                       grid.bounds().width};
  for_rows(height, [&](Rows rows) {
    float depth_m[KeyframeGrid::most_columns];
    std::int32_t places[KeyframeGrid::most_columns];
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < width; ++x) depth_m[x] = KeyframeGrid::depth_m(keyframe.depth(x, y));
      find_pixels({grid_.rays().x(y), grid_.rays().y(y), depth_m, width}, view, places, depth_m);
      for (int x = 0; x < width; ++x) {
        if (places[x] < 0) {
          sights(x, y) = Sight(Sight::aside, 0);
          continue;
        }
        const float tolerance_m = between_cameras.at(depth_m[x]);
        const float beyond_m = testimony.depth_m.data()[places[x]] - depth_m[x];
        const Sight::Kind kind = beyond_m > tolerance_m    ? Sight::through
                                 : beyond_m > -tolerance_m ? Sight::same
                                                           : Sight::hidden;
        sights(x, y) = Sight(kind, places[x]);
      }
    }
  });
}

void KeyframePreparation::find_samples(Keyframe& keyframe) {
  FrameSet frame;
  show(keyframe, frame);
  Poses poses;
  poses.color_from_depth.emplace_back(RigidTransform());
  sampler_.sample(frame, poses, masks_, samples_);
  keyframe.samples.clear();
  const std::size_t step = samples_.surfaces.size() / most_samples + 1;
  for (std::size_t i = 0; i < samples_.surfaces.size(); i += step) {
    keyframe.samples.push_back(samples_.surfaces[i]);
  }
}

Rig keyframe_rig(const Rig& rig, const KeyframeGrid& grid) {
  Rig result;
  result.color = rig.color;
  result.rgbd.push_back(grid.camera());
  return result;
}

OcclusionMasks keyframe_masks(const Rig& rig, const KeyframeGrid& grid) {
  OcclusionMasks masks;
  masks.rgbd_color.emplace_back(rig.color.width, rig.color.height);
  masks.rgbd_depth.emplace_back(grid.intrinsics().width, grid.intrinsics().height);
  return masks;
}

void show(const Keyframe& keyframe, FrameSet& frame) {
  frame.rgbd.resize(1);
  frame.rgbd[0].color = ImageView<Bgr>(keyframe.picture);
  frame.rgbd[0].depth = ImageView<std::uint16_t>(keyframe.depth);
}

}  // namespace diminish
