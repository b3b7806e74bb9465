#include "composite/compositor.h"

#include <algorithm>
#include <atomic>

#include "core/rows.h"
#include "core/stopwatch.h"

namespace diminish {
namespace {

struct Counts {
  int mask = 0, missing = 0;
};

/// Sorts columns [begin, end) of a row into camera, seen and missing. source: of the columns
/// [drawn_begin, drawn_end); nothing is seen beyond.
Counts sort_row(const std::uint8_t* mask, const std::uint8_t* source, int begin, int end,
                int drawn_begin, int drawn_end, std::uint8_t* origin, std::uint8_t* missing) {
  for (int x = begin; x < end; ++x) {
    origin[x] = mask[x] != 0 ? provenance::inpainted : provenance::camera;
  }
  for (int x = drawn_begin; x < drawn_end; ++x) {
    origin[x] = mask[x] != 0 && source[x] != 0 ? source[x] : origin[x];
  }
  Counts counts;
  for (int x = begin; x < end; ++x) {
    const bool is_missing = origin[x] == provenance::inpainted;
    missing[x] = is_missing ? 255 : 0;
    counts.missing += is_missing ? 1 : 0;
    counts.mask += mask[x] != 0 ? 1 : 0;
  }
  return counts;
}

/// Copies the camera's picture and sorts the mask's pixels into seen and missing.
/// missing_box: where `missing` was set before; becomes where it is now.
void sort_pixels(const Image<Bgr>& camera, const OcclusionMasks& masks, DiminishedFrame& result,
                 Mask& missing, Rect& missing_box) {
  const int width = camera.width();
  const int height = camera.height();
  result.picture.resize(width, height);
  result.mask.resize(width, height);
  result.provenance.resize(width, height);
  if (missing.width() == width && missing.height() == height) {
    missing.fill(missing_box, 0);
  } else {
    missing.resize(width, height, 0);
  }
  const Rect objects = bounding_box(masks.color);
  missing_box = objects;
  const Rect drawn = intersect(objects, result.reconstruction.region);
  std::atomic<std::size_t> mask_pixels = 0;
  std::atomic<std::size_t> missing_pixels = 0;
  for_rows(height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      std::copy_n(camera.row(y), width, result.picture.row(y));
      std::copy_n(masks.color.row(y), width, result.mask.row(y));
      std::fill_n(result.provenance.row(y), width, provenance::camera);
      if (y < objects.y || y >= objects.bottom()) continue;
      const bool is_drawn = y >= drawn.y && y < drawn.bottom();
      const Counts counts =
          sort_row(masks.color.row(y), is_drawn ? result.reconstruction.source.row(y) : nullptr,
                   objects.x, objects.right(), is_drawn ? drawn.x : 0, is_drawn ? drawn.right() : 0,
                   result.provenance.row(y), missing.row(y));
      mask_pixels += static_cast<std::size_t>(counts.mask);
      missing_pixels += static_cast<std::size_t>(counts.missing);
    }
  });
  FrameReport& report = result.report;
  report.mask_pixels = mask_pixels;
  report.missing_pixels = missing_pixels;
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
