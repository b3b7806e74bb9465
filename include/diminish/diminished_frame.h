#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "diminish/gpu_pass.h"
#include "diminish/image.h"
#include "diminish/occlusion_masks.h"
#include "diminish/poses.h"
#include "diminish/reconstruction.h"
#include "diminish/stage.h"
#include "diminish/surfaces.h"

namespace diminish {

/// Where a pixel of the picture comes from. Values 1 to 199: RGB-D camera `value - 1`.
namespace provenance {
inline constexpr std::uint8_t camera = 0;
inline constexpr std::uint8_t first_rgbd = 1;
/// Seen by the colour camera earlier. An RGB-D camera sees now that it is still there.
inline constexpr std::uint8_t witnessed = 200;
/// Seen by the colour camera earlier. No camera looks there now.
inline constexpr std::uint8_t remembered = 201;
/// Seen by an RGB-D camera's colour sensor, but not by its depth sensor: where it is was estimated.
/// Part of a bar, such as a steel pipe, whose colours are the colour camera's, from where the bar
/// leaves the mask (Options::draw_bars); or a gap between measured depths (Options::close_gaps).
inline constexpr std::uint8_t estimated = 202;
inline constexpr std::uint8_t inpainted = 254;
inline constexpr std::uint8_t unknown = 255;  ///< part of the object, with nothing to show there
}  // namespace provenance

/// What the memory holds after a frame, and how old what it shows is.
struct MemoryReport {
  std::size_t keyframes = 0;  ///< pictures of the colour camera
  std::size_t bytes = 0;
  /// Of the remembered ones (provenance::remembered): of a scan.
  std::size_t background_pixels = 0;
  /// How long ago the others were seen: half of them at most `median_age_s`. 0 if there are none.
  double median_age_s = 0, oldest_age_s = 0;
};

/// A report about a frame.
struct FrameReport {
  Markers markers;
  Poses poses;  ///< as refined, where something is drawn
  std::vector<OccluderReport> occluders;
  /// RGB-D cameras that were not drawn, because others show all that they see behind the objects;
  /// `poses.color_from_depth` has none of theirs. Empty: none.
  std::vector<bool> spared;
  std::size_t mask_pixels = 0;        ///< to be replaced
  std::size_t valid_pixels = 0;       ///< of these, seen by an RGB-D camera now, or remembered
  std::size_t witnessed_pixels = 0;   ///< of the valid ones (provenance::witnessed)
  std::size_t remembered_pixels = 0;  ///< likewise (provenance::remembered)
  std::size_t estimated_pixels = 0;   ///< likewise (provenance::estimated)
  std::size_t missing_pixels = 0;     ///< of the mask's, none of these
  /// For each RGB-D camera, how well what it sees fits the picture: a correlation, -1 to 1. Nothing
  /// where they see too little of the same, or nothing is drawn.
  std::vector<std::optional<double>> fit;
  /// One of them is below the option `least_fit`. The option `on_doubt` says what is shown then.
  bool in_doubt = false;
  MemoryReport memory;
  StageTimes milliseconds{};
  double frame_ms = 0;  ///< of the whole frame
  DrawingReport drawing;
  /// The frame's colour image could not be read, so there is no picture.
  bool skipped = false;
  /// Images that could not be used (see FrameSet::faults).
  std::vector<std::string> faults;
  /// What could not be done, in plain words.
  std::vector<std::string> messages;
};

/// The pipeline's output: the colour camera's view without the objects.
struct DiminishedFrame {
  std::string name;
  std::size_t index = 0;
  double stamp_s = 0;
  Image<Bgr> picture;  ///< equals the input, bit for bit, where `mask` is 0
  Mask mask;
  Image<std::uint8_t> provenance;
  /// The mask's bounding box: outside it mask and provenance are 0. The next frame in this memory
  /// clears them only inside it.
  Rect objects;
  Reconstruction reconstruction;
  Surfaces surfaces;
  FrameReport report;
};

}  // namespace diminish
