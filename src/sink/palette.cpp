#include "sink/palette.h"

#include "composite/view_mode_rules.h"
#include "diminish/diminished_frame.h"

namespace diminish {

const std::vector<Bgr>& provenance_palette() {
  static const std::vector<Bgr> palette = [] {
    const Bgr cameras[] = {{80, 175, 76}, {243, 150, 33}, {7, 193, 255},
                           {212, 188, 0}, {176, 39, 156}, {34, 87, 255}};
    std::vector<Bgr> colors(256);
    for (std::size_t value = provenance::first_rgbd; value < colors.size(); ++value) {
      colors[value] = cameras[(value - provenance::first_rgbd) % std::size(cameras)];
    }
    colors[provenance::camera] = {64, 64, 64};
    colors[provenance::witnessed] = provenance_view::witnessed_color;
    colors[provenance::remembered] = provenance_view::remembered_color;
    colors[provenance::estimated] = provenance_view::estimated_color;
    colors[provenance::inpainted] = {230, 60, 230};
    colors[provenance::unknown] = {0, 0, 0};
    return colors;
  }();
  return palette;
}

}  // namespace diminish
