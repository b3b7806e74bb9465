#include "pipeline/inventions.h"

#include <utility>

#include "core/tasks.h"

namespace diminish {

Inventions::Inventions(const Rig& rig)
    : standing_things_(rig), plane_texture_(rig.color), steady_(rig.color) {}

void Inventions::find_lines(const FrameSet& frame, const Mask& occlusion, const Rect& objects) {
  rim_lines_.clear();
  if (!objects.empty() && (wanted_.lines || wanted_.bars)) {
    rim_lines_.find(frame.color, occlusion, objects);
  }
}

bool Inventions::looks_for_structure(const Inputs& inputs) const {
  return finds_sides(inputs) || finds_bars(inputs);
}

void Inventions::find_structure(const Inputs& inputs, DiminishedFrame& result) {
  const bool has_sides = finds_sides(inputs);
  if (has_sides) {
    // Its memory, which comes back filled.
    std::swap(result.surfaces.standing_depth_m, with_sides_.standing_depth_m);
    standing_things_.find({inputs.frame, inputs.poses, inputs.masks, inputs.objects,
                           result.reconstruction, *inputs.planes},
                          result.surfaces, with_sides_);
  }
  if (finds_bars(inputs)) {
    // Without a pose it is not known where earlier frames' bars are.
    const auto& pose = inputs.poses.color_from_world;
    const bool remembers = wanted_.steady && pose;
    recalled_bars_.clear();
    if (remembers) known_bars_.recall(*pose, inputs.views, inputs.masks.color, recalled_bars_);
    bar_search_.find({rim_lines_.lines(), inputs.views, *inputs.planes,
                      has_sides ? with_sides_ : result.surfaces, inputs.masks.color,
                      recalled_bars_});
    if (remembers) known_bars_.keep(*pose, inputs.views, bar_search_.bars());
  }
}

void Inventions::fill(const Inputs& inputs, const Compositor::Inputs& composed,
                      Compositor& compositor, Inpainter& inpainter, DiminishedFrame& result) {
  if (finds_sides(inputs)) {
    std::swap(result.surfaces.label, with_sides_.label);
    std::swap(result.surfaces.standing_depth_m, with_sides_.standing_depth_m);
    Compositor::hide_behind_sides(composed, result);
  }
  const bool has_grain =
      wanted_.grain && inputs.planes != nullptr && result.report.missing_pixels > 0;
  const auto grain = [&] {
    return PlaneTexture::Inputs{inputs.frame.color,      inputs.masks.color,
                                inputs.objects,          *inputs.planes,
                                inputs.samples.surfaces, inputs.poses.color_from_world};
  };
  const bool has_bars = finds_bars(inputs) && !bar_search_.bars().empty();
  const auto bars = [&] {
    return BarPainting::Input{bar_search_.bars(),    inputs.views,       *inputs.planes,
                              inputs.frame.color,    inputs.masks.color, result.surfaces,
                              result.reconstruction, inputs.objects};
  };
  bool is_filled = false;
  do_all([&] { is_filled = compositor.inpaint(composed, inpainter, result); },
         [&] {
           if (has_grain) plane_texture_.find(grain(), result);
         },
         [&] {
           if (has_bars) bar_painting_.lay_out(bars());
         });
  if (!is_filled) Compositor::mark_unknown(inputs.objects, result);
  if (has_bars) bar_painting_.paint(bars(), result);
  if (wanted_.steady) {
    steady_.steady(
        {inputs.frame.stamp_s, inputs.poses.color_from_world, inputs.objects, inputs.planes},
        result);
  }
  if (has_grain) plane_texture_.add(grain(), result);
}

}  // namespace diminish
