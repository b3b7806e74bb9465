#include "diminish/color_corrector.h"

namespace diminish {
namespace {

/// Keeps the reconstruction's colours.
class NoCorrection : public ColorCorrector {
 public:
  Declaration declaration() const override { return {.rule = Declaration::Rule::maps}; }

  void correct(const ColorInputs& inputs, Image<Bgr>& picture) override {
    const auto& [camera, occlusion, reconstruction, maps] = inputs;
    const Rect& region = reconstruction.region;
    for (int y = region.y; y < region.bottom(); ++y) {
      for (int x = region.x; x < region.right(); ++x) {
        const Bgra& color = reconstruction.color(x, y);
        if (occlusion(x, y) != 0 && color.a != 0) picture(x, y) = {color.b, color.g, color.r};
      }
    }
  }
};

const bool none_correction_registered =
    Registry<ColorCorrector>::add("none", [] { return std::make_unique<NoCorrection>(); });

}  // namespace
}  // namespace diminish
