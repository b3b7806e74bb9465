#pragma once

#include "diminish/options.h"

namespace diminish::testing {

/// Of frames that the GPU can make whole, from drawing to the picture.
inline Options gpu_options() {
  Options options;
  options.memory = "off";
  options.inpaint = "surfaces";
  options.complete_sides = false;
  options.draw_bars = false;
  options.close_gaps = false;
  options.remove_scraps = false;
  options.refine_shadows = false;
  return options;
}

}  // namespace diminish::testing
