#include "memory/witness.h"

#include <algorithm>
#include <cmath>

#include "core/tasks.h"
#include "geometry/point_rows.h"

namespace diminish {
namespace {

/// place: of an image that is so wide, counted row by row.
void extend_to(Rect& box, std::int32_t place, int width) {
  const int y = place / width;
  extend(box, place - y * width, y);
}

}  // namespace

Witness::Witness(const Rig& rig, const KeyframeGrid& grid)
    : grid_(grid), color_(Lens(rig.color)), picture_(rig.color.bounds()) {
  for (const RgbdCamera& camera : rig.rgbd) {
    cameras_.emplace_back(TestimonyGrid(camera.depth));
  }
}

void Witness::find_parts(const Inputs& inputs) {
  constexpr int step = KeyframeGrid::overview_step;
  const Keyframe& keyframe = inputs.keyframe;
  const RayTable& rays = grid_.overview_rays();
  const Rect near = intersect(grow(inputs.region, step * grid_.step()), picture_);
  const PointView to_color{FloatTransform(inputs.color_from_keyframe), color_, near,
                           picture_.width};
  Rect part;
  for (Camera& camera : cameras_) camera.then_part = camera.now_part = {};
  float depth_m[KeyframeGrid::most_columns];
  std::int32_t pixels[KeyframeGrid::most_columns];
  std::int32_t places[KeyframeGrid::most_columns];
  float unused[KeyframeGrid::most_columns];
  for (int y = 0; y < rays.height(); ++y) {
    PointRow row{rays.x(y), rays.y(y), keyframe.overview_m.row(y), rays.width()};
    find_pixels(row, to_color, pixels, unused);
    bool any = false;
    for (int x = 0; x < row.count; ++x) {
      depth_m[x] = 0;
      if (pixels[x] < 0) continue;
      any = true;
      depth_m[x] = row.depth_m[x];
      extend(part, x * step, y * step);
    }
    if (!any) continue;
    row.depth_m = depth_m;
    for (std::size_t k = 0; k < cameras_.size(); ++k) {
      Camera& camera = cameras_[k];
      if (!camera.is_asked) continue;
      const Rect& bounds = camera.grid.bounds();
      const Image<Sight>& sights = keyframe.sights[k];
      find_pixels(row, {camera.from_keyframe, camera.grid.lens(), bounds, bounds.width}, places,
                  unused);
      for (int x = 0; x < row.count; ++x) {
        if (places[x] >= 0) extend_to(camera.now_part, places[x], bounds.width);
        const Sight sight = sights(x * step, y * step);
        if (depth_m[x] > 0 && sight.kind() != Sight::aside) {
          extend_to(camera.then_part, sight.place(), bounds.width);
        }
      }
    }
  }
  constexpr int margin = 8;
  part_ = intersect(grow(part, step), keyframe.depth.bounds());
  for (Camera& camera : cameras_) {
    camera.then_part = grow(camera.then_part, margin);
    camera.now_part = grow(camera.now_part, margin);
  }
}

void Witness::judge(const Inputs& inputs, Image<std::uint16_t>& depth,
                    std::vector<Eigen::Vector3f>& gone) {
  const Keyframe& keyframe = inputs.keyframe;
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    Camera& camera = cameras_[k];
    const auto& color_from_depth = inputs.poses.color_from_depth[k];
    camera.looks = inputs.now[k].is_given && color_from_depth;
    camera.is_asked = camera.looks && !keyframe.sights[k].empty();
    if (camera.looks) {
      camera.from_keyframe =
          FloatTransform(color_from_depth->inverse() * inputs.color_from_keyframe);
    }
    if (!camera.is_asked) camera.now.resize(0, 0);
  }
  find_parts(inputs);
  for_tasks(cameras_.size(), [&](std::size_t k) {
    Camera& camera = cameras_[k];
    if (!camera.is_asked) return;
    camera.comparison.compare({keyframe.testimonies[k], camera.then_part, camera.then},
                              {inputs.now[k], camera.now_part, camera.now});
  });
  // An error in depth must not be seen.
  constexpr float most_px = 6;
  doubted_m_ = color_.fx * static_cast<float>(inputs.color_from_keyframe.translation.norm()) *
               doubt_unit / most_px;
  depth = keyframe.depth;
  confirmed_.resize(depth.width(), depth.height());
  gone.clear();
  for (auto& band : gone_in_band_) band.clear();
  for_rows(part_.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      judge_row(inputs, part_.y + y, depth, gone_in_band_[rows.band]);
    }
  });
  for (const auto& band : gone_in_band_) gone.insert(gone.end(), band.begin(), band.end());
}

void Witness::judge_row(const Inputs& inputs, int y, Image<std::uint16_t>& depth,
                        std::vector<Eigen::Vector3f>& gone) {
  const Keyframe& keyframe = inputs.keyframe;
  std::uint8_t* const confirmed = confirmed_.row(y) + part_.x;
  std::fill_n(confirmed, part_.width, std::uint8_t{0});
  std::uint16_t* const kept = depth.row(y) + part_.x;
  const std::uint8_t* const doubt = keyframe.doubt.row(y) + part_.x;
  for (int x = 0; x < part_.width; ++x) {
    const float least_m = doubted_m_ * static_cast<float>(doubt[x]);
    if (KeyframeGrid::depth_m(kept[x]) < least_m) kept[x] = 0;
  }
  float looked_m[KeyframeGrid::most_columns];  // at what the camera did not see then
  std::int32_t places[KeyframeGrid::most_columns];
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    const Camera& camera = cameras_[k];
    if (!camera.looks) continue;
    const Sight* const sights = camera.is_asked ? keyframe.sights[k].row(y) + part_.x : nullptr;
    bool any = false;
    for (int x = 0; x < part_.width; ++x) {
      const Sight sight = sights ? sights[x] : Sight(Sight::aside, 0);
      looked_m[x] = 0;
      if (kept[x] == 0 || sight.kind() == Sight::through) continue;
      if (sight.kind() != Sight::aside) {
        const Verdict verdict = camera.then.data()[sight.place()];
        if (is_changed(verdict)) {
          if (sight.kind() == Sight::same && verdict == Verdict::gone) {
            gone.push_back(grid_.point_m(part_.x + x, y, kept[x]));
          }
          kept[x] = 0;
          continue;
        }
        if (sight.kind() == Sight::same) {
          confirmed[x] |= verdict == Verdict::same ? 1 : 0;
          continue;
        }
      }
      looked_m[x] = KeyframeGrid::depth_m(kept[x]);
      any = true;
    }
    if (!any) continue;
    const Rect& bounds = camera.grid.bounds();
    find_pixels({grid_.rays().x(y) + part_.x, grid_.rays().y(y) + part_.x, looked_m, part_.width},
                {camera.from_keyframe, camera.grid.lens(), bounds, bounds.width}, places, looked_m);
    for (int x = 0; x < part_.width; ++x) {
      if (places[x] < 0) continue;
      const float seen_m = inputs.now[k].depth_m.data()[places[x]];
      if (seen_m > looked_m[x] + 2 * between_cameras.at(looked_m[x])) kept[x] = 0;
    }
  }
  for (int x = 0; x < part_.width; ++x) {
    if (kept[x] == 0) confirmed[x] = 0;
  }
}

}  // namespace diminish
