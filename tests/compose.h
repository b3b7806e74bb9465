#pragma once

#include <vector>

#include "composite/compositor.h"
#include "diminish/scene_samples.h"
#include "inpaint/rim_lines.h"
#include "pipeline/methods.h"
#include "scene/color_maps.h"

namespace diminish::testing {

/// A frame's stages from colour maps on, but for the drawing, by the methods that the options name.
class Composing {
 public:
  /// result: its reconstruction and surfaces are there.
  void compose(const Image<Bgr>& camera, const Mask& occlusion, const Options& options,
               const std::vector<SceneSample>& samples, DiminishedFrame& result) {
    ColorCorrector& corrector = correctors_.get(options.color_correct);
    maps_.fit(camera, occlusion, samples, corrector.declaration().maps);
    const Rect objects = bounding_box(occlusion);
    lines_.find(camera, occlusion, objects);
    const Compositor::Inputs inputs{camera,  occlusion,       objects,
                                    options, smoothing_share, lines_.lines()};
    Compositor::sort(inputs, result);
    Compositor::correct_colors(inputs, maps_.by_source(), corrector, result);
    // With the light as it is in the surfaces.
    compositor_.lift_shadows(inputs, {}, {}, result);
    Inpainter& inpainter = inpainters_.get(options.inpaint);
    if (!compositor_.inpaint(inputs, inpainter, result)) {
      Compositor::mark_unknown(objects, result);
    }
    compositor_.finish(inputs, modes_.get(options.mode), result);
  }

  int smoothing_share = ColorSmoothing::whole_change;

 private:
  Methods<ColorCorrector> correctors_;
  Methods<Inpainter> inpainters_;
  Methods<ViewMode> modes_;
  ColorMaps maps_;
  RimLines lines_;
  Compositor compositor_;
};

}  // namespace diminish::testing
