#include "composite/compositor.h"

#include <algorithm>

#include "composite/object_pixels.h"
#include "core/conditions.h"
#include "core/rows.h"
#include "core/runs.h"

namespace diminish {
namespace {

/// Pixels.
struct Counts {
  std::size_t mask = 0, missing = 0, witnessed = 0, remembered = 0, estimated = 0;

  friend Counts operator+(const Counts& a, const Counts& b) {
    return {a.mask + b.mask, a.missing + b.missing, a.witnessed + b.witnessed,
            a.remembered + b.remembered, a.estimated + b.estimated};
  }
};

/// Sorts columns [begin, end) of a row into camera, seen and missing. source: of the columns
/// [drawn_begin, drawn_end); nothing is seen beyond.
void sort_row(const std::uint8_t* mask, const std::uint8_t* source, int begin, int end,
              int drawn_begin, int drawn_end, std::uint8_t* origin) {
  for (int x = begin; x < end; ++x) {
    origin[x] = mask[x] != 0 ? provenance::inpainted : provenance::camera;
  }
  for (int x = drawn_begin; x < drawn_end; ++x) {
    const bool is_seen = all_of(mask[x] != 0, source[x] != 0);
    origin[x] = is_seen ? source[x] : origin[x];
  }
}

}  // namespace

void Compositor::sort(const Inputs& inputs, DiminishedFrame& result) {
  const ImageView<Bgr> camera = inputs.camera;
  const Mask& occlusion = inputs.occlusion;
  const Rect& objects = inputs.objects;
  const int width = camera.width();
  const int height = camera.height();
  result.picture.resize(width, height);
  set_objects(occlusion, objects, occlusion.bounds(), result);
  const Rect drawn = intersect(objects, result.reconstruction.region);
  const bool remembers = inputs.options.memory != "off";
  const Counts counts = sum_over_rows(height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      std::copy_n(camera.row(y), width, result.picture.row(y));
      if (y < objects.y || y >= objects.bottom()) continue;
      const bool is_drawn = y >= drawn.y && y < drawn.bottom();
      sort_row(occlusion.row(y), is_drawn ? result.reconstruction.source.row(y) : nullptr,
               objects.x, objects.right(), is_drawn ? drawn.x : 0, is_drawn ? drawn.right() : 0,
               result.provenance.row(y));
    }
    const Rect sorted =
        intersect({objects.x, rows.first, objects.width, rows.last - rows.first}, objects);
    const auto count = [&](std::uint8_t origin) {
      return count_equal(result.provenance, origin, sorted);
    };
    return Counts{count_nonzero(occlusion, sorted), count(provenance::inpainted),
                  remembers ? count(provenance::witnessed) : 0,
                  remembers ? count(provenance::remembered) : 0,
                  inputs.options.close_gaps ? count(provenance::estimated) : 0};
  });
  FrameReport& report = result.report;
  report.mask_pixels = counts.mask;
  report.missing_pixels = counts.missing;
  report.witnessed_pixels = counts.witnessed;
  report.remembered_pixels = counts.remembered;
  report.estimated_pixels = counts.estimated;
  report.valid_pixels = report.mask_pixels - report.missing_pixels;
}

void Compositor::hide_behind_sides(const Inputs& inputs, DiminishedFrame& result) {
  if (result.surfaces.standing_depth_m.empty()) return;
  const Rect part = intersect(inputs.objects, result.surfaces.region);
  std::size_t hidden = 0;
  std::size_t estimated = 0;
  for (int y = part.y; y < part.bottom(); ++y) {
    const std::uint8_t* const label = result.surfaces.label.row(y);
    std::uint8_t* const origin = result.provenance.row(y);
    for_each_run(label, part.x, part.right(), surface_label::standing, [&](int first, int last) {
      hidden += static_cast<std::size_t>(last - first) -
                static_cast<std::size_t>(
                    std::count(origin + first, origin + last, provenance::inpainted));
      estimated += static_cast<std::size_t>(
          std::count(origin + first, origin + last, provenance::estimated));
      std::fill(origin + first, origin + last, provenance::inpainted);
    });
  }
  result.report.missing_pixels += hidden;
  result.report.valid_pixels -= hidden;
  result.report.estimated_pixels -= estimated;
}

void Compositor::correct_colors(const Inputs& inputs, ColorMapsBySource maps,
                                ColorCorrector& corrector, DiminishedFrame& result) {
  if (result.report.valid_pixels > 0) {
    corrector.correct({inputs.camera, inputs.occlusion, result.reconstruction, maps},
                      result.picture);
  }
}

void Compositor::lift_shadows(const Inputs& inputs, std::span<const CastShadow> shadows,
                              const SceneSamples& samples, DiminishedFrame& result) {
  if (!result.surfaces.light.empty()) {
    if (inputs.options.refine_shadows) {
      shadow_gain_.apply({result.picture, result.provenance, shadows, samples.surfaces},
                         result.surfaces);
    }
    shadow_lifting_.lift(result.surfaces, result.picture);
  }
  if (result.report.witnessed_pixels + result.report.remembered_pixels > 0) {
    show_remembered(inputs.objects, result);
  }
}

/// The colour camera's own colours, which were seen without the objects' shadows.
void Compositor::show_remembered(const Rect& part, DiminishedFrame& result) {
  for_rows(part.height, [&](Rows rows) {
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      for (int x = part.x; x < part.right(); ++x) {
        const std::uint8_t origin = result.provenance(x, y);
        if (origin != provenance::witnessed && origin != provenance::remembered) continue;
        const Bgra& color = result.reconstruction.color(x, y);
        result.picture(x, y) = {color.b, color.g, color.r};
      }
    }
  });
}

bool Compositor::inpaint(const Inputs& inputs, Inpainter& inpainter, DiminishedFrame& result) {
  if (result.report.missing_pixels == 0) return true;
  const Mask& occlusion = inputs.occlusion;
  if (missing_.width() == occlusion.width() && missing_.height() == occlusion.height()) {
    missing_.fill(missing_part_, 0);
  } else {
    missing_ = Mask(occlusion.width(), occlusion.height());
  }
  const Rect part = inputs.objects;
  missing_part_ = part;
  for (int y = part.y; y < part.bottom(); ++y) {
    const std::uint8_t* const origin = result.provenance.row(y) + part.x;
    std::transform(origin, origin + part.width, missing_.row(y) + part.x,
                   [](std::uint8_t from) { return from == provenance::inpainted ? 255 : 0; });
  }
  const Holes holes{missing_,     occlusion, result.surfaces, result.reconstruction.depth_m,
                    inputs.lines, part};
  return inpainter.inpaint(holes, inputs.options, result.picture);
}

void Compositor::mark_unknown(const Rect& objects, DiminishedFrame& result) {
  for (int y = objects.y; y < objects.bottom(); ++y) {
    std::uint8_t* const origin = result.provenance.row(y) + objects.x;
    std::replace(origin, origin + objects.width, provenance::inpainted, provenance::unknown);
  }
}

void Compositor::finish(const Inputs& inputs, const ViewMode& mode, DiminishedFrame& result) {
  const auto& [camera, occlusion, objects, options, smoothing_share, lines] = inputs;
  const bool has_shadows = !result.surfaces.light.empty();
  if (options.smooth_colors && result.report.valid_pixels > 0) {
    color_smoothing_.smooth(result.provenance, intersect(objects, result.reconstruction.region),
                            smoothing_share, result.picture);
  }
  if (has_shadows && !options.remove_shadows) {
    shadow_lifting_.restore_outside(camera, occlusion, result.surfaces, result.picture);
  }
  if (result.report.mask_pixels == 0) return;
  const int width_px = soft_rim_width_px(options, has_shadows);
  soft_rim_.blend(camera, occlusion, objects, width_px, result.picture);
  mode.show(camera, options, result);
}

}  // namespace diminish
