#include "memory/witness.h"

#include <algorithm>
#include <cmath>

#include "core/rows.h"
#include "core/tasks.h"

namespace diminish {

/// From the keyframe's frame to an RGB-D camera's.
struct Witness::View {
  std::size_t k;
  FloatTransform then, now;
};

Witness::Witness(const Rig& rig, const KeyframeGrid& grid) : grid_(grid), color_(Lens(rig.color)) {
  for (const RgbdCamera& camera : rig.rgbd) cameras_.push_back({TestimonyTaker(camera), {}, {}});
}

Verdict Witness::was_there(std::size_t k, const Eigen::Vector3f& x_in_depth) const {
  const Camera& camera = cameras_[k];
  const auto pixel = project(camera.taker.depth_lens(), x_in_depth, 1.F / Testimony::step);
  if (!pixel || !camera.now.bounds().contains(pixel->x, pixel->y)) return Verdict::unknown;
  return camera.now(pixel->x, pixel->y);
}

bool Witness::has_changed(const View& view, const Inputs& inputs, const Eigen::Vector3f& point,
                          bool& is_gone) const {
  const Camera& camera = cameras_[view.k];
  const auto look = [&](const Eigen::Vector3f& x_in_depth,
                        const Testimony& testimony) -> std::optional<Pixel> {
    const auto pixel = project(camera.taker.depth_lens(), x_in_depth, 1.F / Testimony::step);
    return pixel && testimony.depth_m.bounds().contains(pixel->x, pixel->y) ? pixel : std::nullopt;
  };
  const Testimony& then = inputs.keyframe.testimonies[view.k];
  const Eigen::Vector3f x_then = transform(view.then, point);
  if (const auto pixel = look(x_then, then)) {
    const float tolerance_m = between_cameras.at(x_then.z());
    const float beyond_m = then.depth_m(pixel->x, pixel->y) - x_then.z();
    // Nothing was there, for this camera: an error of calibration, so it cannot say.
    if (beyond_m > tolerance_m) return false;
    const Verdict verdict = camera.then(pixel->x, pixel->y);
    if (beyond_m > -tolerance_m) {
      is_gone = verdict == Verdict::gone;
      return is_changed(verdict);
    }
    // Hidden by something that has changed, or not measured beside it.
    if (is_changed(verdict)) return true;
  }
  const Testimony& now = inputs.now[view.k];
  const Eigen::Vector3f x_now = transform(view.now, point);
  const auto pixel = look(x_now, now);
  return pixel && now.depth_m(pixel->x, pixel->y) > x_now.z() + 2 * between_cameras.at(x_now.z());
}

template <class Visit>
void Witness::for_each_in_part(const Keyframe& keyframe, const FloatTransform& to_color,
                               const Rect& part, const Visit& visit) const {
  constexpr int stride = 4;
  for (int y = 0; y < keyframe.depth.height(); y += stride) {
    for (int x = 0; x < keyframe.depth.width(); x += stride) {
      if (keyframe.depth(x, y) == 0) continue;
      const Eigen::Vector3f point = grid_.point_m(x, y, keyframe.depth(x, y));
      const auto pixel = project(color_, transform(to_color, point));
      if (pixel && part.contains(pixel->x, pixel->y)) visit(point);
    }
  }
}

void Witness::judge(const Inputs& inputs, Image<std::uint16_t>& depth,
                    std::vector<Eigen::Vector3f>& gone) {
  const Keyframe& keyframe = inputs.keyframe;
  std::vector<View> views;
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    const auto& color_from_depth = inputs.poses.color_from_depth[k];
    const auto& then = keyframe.color_from_depth[k];
    if (!inputs.now[k].is_given || !keyframe.testimonies[k].is_given || !color_from_depth ||
        !then) {
      cameras_[k].now.resize(0, 0);
      continue;
    }
    views.push_back({k, FloatTransform(then->inverse()),
                     FloatTransform(color_from_depth->inverse() * inputs.color_from_keyframe)});
  }
  const Rect part = grow(inputs.region, grid_.step());
  const FloatTransform to_color(inputs.color_from_keyframe);
  for_tasks(views.size(), [&](std::size_t i) {
    const View& view = views[i];
    Camera& camera = cameras_[view.k];
    // Where the cameras see what is in the region.
    Rect then;
    Rect now;
    for_each_in_part(keyframe, to_color, part, [&](const Eigen::Vector3f& point) {
      for (const auto& [to_depth, box] : {std::pair(&view.then, &then), {&view.now, &now}}) {
        const auto pixel =
            project(camera.taker.depth_lens(), transform(*to_depth, point), 1.F / Testimony::step);
        if (pixel && camera.taker.grid().contains(pixel->x, pixel->y)) {
          extend(*box, pixel->x, pixel->y);
        }
      }
    });
    constexpr int margin = 8;
    camera.taker.compare({keyframe.testimonies[view.k], grow(then, margin), camera.then},
                         {inputs.now[view.k], grow(now, margin), camera.now});
  });
  depth = keyframe.depth;
  std::vector<Eigen::Vector3f> gone_in_band[most_bands];
  // A guess may be wrong by so much of its depth, which must not be seen.
  constexpr float guess_error = 0.2F;
  constexpr float most_px = 6;
  const float least_guess_m = color_.fx *
                              static_cast<float>(inputs.color_from_keyframe.translation.norm()) *
                              guess_error / most_px;
  for_rows(depth.height(), [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < depth.width(); ++x) {
        if (depth(x, y) == 0) continue;
        const Eigen::Vector3f point = grid_.point_m(x, y, depth(x, y));
        if (keyframe.guessed(x, y) != 0 && point.z() < least_guess_m) {
          depth(x, y) = 0;
          continue;
        }
        const auto pixel = project(color_, transform(to_color, point));
        if (!pixel || !part.contains(pixel->x, pixel->y)) continue;
        for (const View& view : views) {
          bool is_gone = false;
          if (!has_changed(view, inputs, point, is_gone)) continue;
          depth(x, y) = 0;
          if (is_gone) gone_in_band[rows.band].push_back(point);
          break;
        }
      }
    }
  });
  gone.clear();
  for (const auto& band : gone_in_band) gone.insert(gone.end(), band.begin(), band.end());
}

}  // namespace diminish
