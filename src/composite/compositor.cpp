#include "composite/compositor.h"

#include <algorithm>
#include <string_view>

#include "core/rows.h"
#include "core/stopwatch.h"
#include "diminish/error.h"

namespace diminish {
namespace {

/// Pixels.
struct Counts {
  std::size_t mask = 0, missing = 0;

  friend Counts operator+(const Counts& a, const Counts& b) {
    return {a.mask + b.mask, a.missing + b.missing};
  }
};

/// Sorts columns [begin, end) of a row into camera, seen and missing. source: of the columns
/// [drawn_begin, drawn_end); nothing is seen beyond.
void sort_row(const std::uint8_t* mask, const std::uint8_t* source, int begin, int end,
              int drawn_begin, int drawn_end, std::uint8_t* origin, std::uint8_t* missing) {
  for (int x = begin; x < end; ++x) {
    origin[x] = mask[x] != 0 ? provenance::inpainted : provenance::camera;
  }
  for (int x = drawn_begin; x < drawn_end; ++x) {
    origin[x] = mask[x] != 0 && source[x] != 0 ? source[x] : origin[x];
  }
  for (int x = begin; x < end; ++x) {
    missing[x] = origin[x] == provenance::inpainted ? 255 : 0;
  }
}

/// Clears `missing`. objects: the last mask's bounding box, outside of which nothing of it is set.
void clear_missing(const Mask& occlusion, const Rect& objects, Mask& missing) {
  if (missing.width() == occlusion.width() && missing.height() == occlusion.height()) {
    missing.fill(objects, 0);
  } else {
    missing.resize(occlusion.width(), occlusion.height(), 0);
  }
}

/// Copies the camera's picture and sorts the mask's pixels into seen and missing.
/// objects: the mask's bounding box. missing: nothing of it is set.
void sort_pixels(const Image<Bgr>& camera, const Mask& occlusion, const Rect& objects,
                 DiminishedFrame& result, Mask& missing) {
  const int width = camera.width();
  const int height = camera.height();
  result.picture.resize(width, height);
  result.mask.resize(width, height);
  result.provenance.resize(width, height);
  const Rect drawn = intersect(objects, result.reconstruction.region);
  const Counts counts = sum_over_rows(height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      std::copy_n(camera.row(y), width, result.picture.row(y));
      std::copy_n(occlusion.row(y), width, result.mask.row(y));
      std::fill_n(result.provenance.row(y), width, provenance::camera);
      if (y < objects.y || y >= objects.bottom()) continue;
      const bool is_drawn = y >= drawn.y && y < drawn.bottom();
      sort_row(occlusion.row(y), is_drawn ? result.reconstruction.source.row(y) : nullptr,
               objects.x, objects.right(), is_drawn ? drawn.x : 0, is_drawn ? drawn.right() : 0,
               result.provenance.row(y), missing.row(y));
    }
    const Rect sorted =
        intersect({objects.x, rows.first, objects.width, rows.last - rows.first}, objects);
    return Counts{count_nonzero(occlusion, sorted), count_nonzero(missing, sorted)};
  });
  FrameReport& report = result.report;
  report.mask_pixels = counts.mask;
  report.missing_pixels = counts.missing;
  report.valid_pixels = report.mask_pixels - report.missing_pixels;
}

constexpr std::string_view gpu_prefix = "gl_";

std::string without_gpu_prefix(const std::string& name) {
  return name.starts_with(gpu_prefix) ? name.substr(gpu_prefix.size()) : name;
}

/// Calls work(method). Where the frame was drawn on the GPU, and there is a method "gl_" + name, by
/// that; where it fails, by the processor's.
template <class Interface, class Work>
void on_gpu_or_processor(const std::string& name,
                         std::map<std::string, std::unique_ptr<Interface>>& made,
                         FrameReport& report, const Work& work) {
  const bool is_asked_for = name.starts_with(gpu_prefix);
  const std::string on_processor = without_gpu_prefix(name);
  const std::string on_gpu = std::string(gpu_prefix) + on_processor;
  const bool is_drawn_on_gpu = !report.drawing.device.empty();
  if ((is_asked_for || is_drawn_on_gpu) && Registry<Interface>::contains(on_gpu)) {
    try {
      return work(on_gpu);
    } catch (const Error& error) {
      // The next frame begins anew.
      made.erase(on_gpu);
      report.messages.push_back(std::string(error.what()) + "; done by the processor instead");
    }
  }
  work(on_processor);
}

}  // namespace

void Compositor::prepare(const Image<Bgr>& camera, const Mask& occlusion, const Options& options,
                         const std::vector<SceneSample>& samples) {
  corrector(without_gpu_prefix(options.color_correct)).prepare(camera, occlusion, samples);
}

void Compositor::composite(const Image<Bgr>& camera, const Mask& occlusion, const Rect& objects,
                           const Options& options, DiminishedFrame& result) {
  StageTimes& milliseconds = result.report.milliseconds;
  {
    const ScopedTimer timer(milliseconds, Stage::compositing);
    clear_missing(occlusion, objects_, missing_);
    objects_ = objects;
    sort_pixels(camera, occlusion, objects, result, missing_);
  }
  if (result.report.valid_pixels > 0) {
    const ScopedTimer timer(milliseconds, Stage::color_correction);
    correct_colors(camera, occlusion, options.color_correct, result);
  }
  if (!result.reconstruction.light.empty()) {
    const ScopedTimer timer(milliseconds, Stage::color_correction);
    shadow_lifting_.lift(result.reconstruction, result.picture);
  }
  show(camera, occlusion, options, result);
}

void Compositor::complete(const Image<Bgr>& camera, const Mask& occlusion, const Rect& objects,
                          const Options& options, DiminishedFrame& result) {
  {
    const ScopedTimer timer(result.report.milliseconds, Stage::compositing);
    clear_missing(occlusion, objects_, missing_);
    objects_ = objects;
    for (int y = objects_.y; y < objects_.bottom(); ++y) {
      const std::uint8_t* origin = result.provenance.row(y);
      std::uint8_t* missing = missing_.row(y);
      for (int x = objects_.x; x < objects_.right(); ++x) {
        missing[x] = origin[x] == provenance::inpainted ? 255 : 0;
      }
    }
  }
  show(camera, occlusion, options, result);
}

/// Inpainting and what comes after it. (What is missing is filled from pixels as they were seen:
/// that is 0.1 dB better than from smoothed ones.)
void Compositor::show(const Image<Bgr>& camera, const Mask& occlusion, const Options& options,
                      DiminishedFrame& result) {
  StageTimes& milliseconds = result.report.milliseconds;
  const bool has_shadows = !result.reconstruction.light.empty();
  if (result.report.missing_pixels > 0) {
    const ScopedTimer timer(milliseconds, Stage::inpainting);
    if (!inpaint({missing_, occlusion, result.reconstruction}, options, result)) {
      std::replace(result.provenance.begin(), result.provenance.end(), provenance::inpainted,
                   provenance::unknown);
    }
  }
  if (options.smooth_colors && result.report.valid_pixels > 0) {
    const ScopedTimer timer(milliseconds, Stage::color_correction);
    color_smoothing_.smooth(result.provenance, intersect(objects_, result.reconstruction.region),
                            result.picture);
  }
  if (has_shadows && !options.remove_shadows) {
    const ScopedTimer timer(milliseconds, Stage::color_correction);
    shadow_lifting_.restore_outside(camera, occlusion, result.reconstruction, result.picture);
  }
  if (result.report.mask_pixels > 0) {
    const ScopedTimer timer(milliseconds, Stage::compositing);
    const int width_px = soft_rim_width_px(options, has_shadows);
    soft_rim_.blend(camera, occlusion, objects_, width_px, result.picture);
    view_mode(options.mode).show(camera, options, result);
  }
}

bool Compositor::uses_surfaces(const Options& options) {
  return options.lift_shadows || options.remove_shadows ||
         inpainter(without_gpu_prefix(options.inpaint)).uses_surfaces();
}

void Compositor::correct_colors(const Image<Bgr>& camera, const Mask& occlusion,
                                const std::string& name, DiminishedFrame& result) {
  on_gpu_or_processor(name, correctors_, result.report, [&](const std::string& method) {
    corrector(method).correct(camera, occlusion, result.reconstruction, result.picture);
  });
}

bool Compositor::inpaint(const Holes& holes, const Options& options, DiminishedFrame& result) {
  bool filled = false;
  on_gpu_or_processor(options.inpaint, inpainters_, result.report, [&](const std::string& method) {
    filled = inpainter(method).inpaint(holes, options, result.picture);
  });
  return filled;
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

const ViewMode& Compositor::view_mode(const std::string& name) {
  auto& found = view_modes_[name];
  if (!found) found = Registry<ViewMode>::get(name)();
  return *found;
}

}  // namespace diminish
