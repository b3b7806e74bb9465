#include "composite/compositor.h"

#include <algorithm>

#include "core/stopwatch.h"

namespace diminish {
namespace {

/// Copies the camera's picture and sorts the mask's pixels into seen and missing.
/// missing_box: where `missing` was set before; becomes where it is now.
void sort_pixels(const Image<Bgr>& camera, const OcclusionMasks& masks, DiminishedFrame& result,
                 Mask& missing, Rect& missing_box) {
  result.picture = camera;
  result.mask = masks.color;
  result.provenance.resize(camera.width(), camera.height(), provenance::camera);
  if (missing.width() == camera.width() && missing.height() == camera.height()) {
    missing.fill(missing_box, 0);
  } else {
    missing.resize(camera.width(), camera.height(), 0);
  }
  FrameReport& report = result.report;
  const Rect objects = bounding_box(masks.color);
  missing_box = objects;
  const Rect drawn = intersect(objects, result.reconstruction.region);
  for (int y = objects.y; y < objects.bottom(); ++y) {
    const std::uint8_t* mask = masks.color.row(y);
    std::uint8_t* origin = result.provenance.row(y);
    for (int x = objects.x; x < objects.right(); ++x) {
      origin[x] = mask[x] != 0 ? provenance::inpainted : provenance::camera;
    }
    if (y >= drawn.y && y < drawn.bottom()) {
      const std::uint8_t* source = result.reconstruction.source.row(y);
      for (int x = drawn.x; x < drawn.right(); ++x) {
        origin[x] = mask[x] != 0 && source[x] != 0 ? source[x] : origin[x];
      }
    }
    std::uint8_t* unseen = missing.row(y);
    int mask_pixels = 0;
    int missing_pixels = 0;
    for (int x = objects.x; x < objects.right(); ++x) {
      const bool is_missing = origin[x] == provenance::inpainted;
      unseen[x] = is_missing ? 255 : 0;
      missing_pixels += is_missing ? 1 : 0;
      mask_pixels += mask[x] != 0 ? 1 : 0;
    }
    report.mask_pixels += static_cast<std::size_t>(mask_pixels);
    report.missing_pixels += static_cast<std::size_t>(missing_pixels);
  }
  report.valid_pixels = report.mask_pixels - report.missing_pixels;
}

}  // namespace

void Compositor::composite(const Image<Bgr>& camera, const OcclusionMasks& masks,
                           const Options& options, DiminishedFrame& result) {
  StageTimes& milliseconds = result.report.milliseconds;
  {
    const ScopedTimer timer(milliseconds, Stage::compositing);
    sort_pixels(camera, masks, result, missing_, missing_box_);
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
