#include "composite/compositor.h"

#include <algorithm>

#include "core/stopwatch.h"

namespace diminish {
namespace {

/// Copies the camera's picture and sorts the mask's pixels into seen and missing.
void sort_pixels(const Image<Bgr>& camera, const OcclusionMasks& masks, DiminishedFrame& result,
                 Mask& missing) {
  result.picture = camera;
  result.mask = masks.color;
  result.provenance.resize(camera.width(), camera.height(), provenance::camera);
  missing.resize(camera.width(), camera.height(), 0);
  FrameReport& report = result.report;
  const Rect& drawn = result.reconstruction.region;
  for (int y = 0; y < camera.height(); ++y) {
    const std::uint8_t* mask = masks.color.row(y);
    for (int x = 0; x < camera.width(); ++x) {
      if (mask[x] == 0) continue;
      ++report.mask_pixels;
      const std::uint8_t source = drawn.contains(x, y) ? result.reconstruction.source(x, y) : 0;
      if (source != 0) {
        ++report.valid_pixels;
        result.provenance(x, y) = source;
      } else {
        ++report.missing_pixels;
        result.provenance(x, y) = provenance::inpainted;
        missing(x, y) = 255;
      }
    }
  }
}

}  // namespace

void Compositor::composite(const Image<Bgr>& camera, const OcclusionMasks& masks,
                           const Options& options, DiminishedFrame& result) {
  StageTimes& milliseconds = result.report.milliseconds;
  {
    const ScopedTimer timer(milliseconds, Stage::compositing);
    sort_pixels(camera, masks, result, missing_);
  }
  if (result.report.valid_pixels > 0) {
    const ScopedTimer timer(milliseconds, Stage::color_correction);
    corrector(options.color_correct)
        .correct(camera, masks.color, result.reconstruction, result.picture);
  }
  if (result.report.missing_pixels > 0) {
    const ScopedTimer timer(milliseconds, Stage::inpainting);
    if (!inpainter(options.inpaint).inpaint(missing_, options, result.picture)) {
      std::replace(result.provenance.begin(), result.provenance.end(), provenance::inpainted,
                   provenance::unknown);
    }
  }
}

ColorCorrector& Compositor::corrector(const std::string& name) {
  auto& found = correctors_[name];
  if (!found) found = Registry<ColorCorrector>::get(name)();
  return *found;
}

Inpainter& Compositor::inpainter(const std::string& name) {
  auto& found = inpainters_[name];
  if (!found) found = Registry<Inpainter>::get(name)();
  return *found;
}

}  // namespace diminish
