#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "diminish/export.h"

namespace diminish {

/// How close a set of pixels is to the truth.
struct Quality {
  double psnr_db = 0;  ///< over the three channels; identical pictures count as 99
  /// Structural similarity of the brightness (Wang et al. 2004: Gaussian window of 11x11, sigma
  /// 1.5).
  double ssim = 0;
};

/// The error of a pose.
struct PoseError {
  double position_mm = 0;
  double rotation_deg = 0;
};

/// Causes of error: the object was not covered; no camera saw the place; the picture is shifted;
/// edges are in the wrong place; neighbouring pixels share a wrong colour; the rest.
inline constexpr std::array<const char*, 6> error_causes{"mask",  "missing", "pose",
                                                         "edges", "color",   "texture"};
/// Shares of the squared error by cause. They sum to 1.
using ErrorBudget = std::array<double, error_causes.size()>;

/// What a viewer notices, inside the true mask (or without one, the run's) grown by a square of 3
/// pixels on each side, in the brightness after a Gaussian of 1 pixel.
struct ViewerFigures {
  /// The share of the truth's edges (Canny) that the result has within 2 pixels, the share of the
  /// result's edges that the truth has, and their harmonic mean.
  double edge_recall = 0, edge_precision = 0, edge_f1 = 0;
  /// The mean similarity of the gradients' magnitudes (Xue et al. 2014, c = 170).
  double gradient_similarity = 0;
  double invented_share = 0;  ///< of the region
  /// The mean gradient magnitude relative to the truth's: 1 is right, 0.2 is a smear. Absent if
  /// there are no such pixels, or at most 50 invented ones.
  std::optional<double> sharpness_seen, sharpness_invented;
  std::optional<Quality> invented;
};

/// Where the scored pixels come from: from an RGB-D camera now; from the colour camera earlier,
/// with an RGB-D camera as a witness or without; from an RGB-D camera's picture without depth; from
/// nowhere.
inline constexpr std::array<const char*, 5> score_origins{"seen", "witnessed", "remembered",
                                                          "estimated", "invented"};
/// The pixels of one origin.
struct OriginScore {
  double share = 0;  ///< of the scored pixels
  Quality quality;
};

/// One frame compared with the truth. Figures that cannot be known (no such pixels, no truth) are
/// absent.
struct FrameScore {
  using Origins = std::array<std::optional<OriginScore>, score_origins.size()>;

  std::string name;
  std::optional<Quality> inside;   ///< inside the true mask, grown by 3 pixels
  std::optional<Quality> valid;    ///< of these, pixels that a camera saw, now or earlier
  std::optional<Quality> missing;  ///< of these, pixels that none saw
  /// By origin; absent where there are no such pixels. What is left of the shares is the camera's
  /// own picture, or the object still visible.
  Origins origins;
  std::optional<ViewerFigures> viewer;
  std::optional<ErrorBudget> budget;
  std::optional<double> coverage;  ///< the share of the run's mask that an RGB-D camera saw
  /// Intersection over union of the run's mask and the true mask grown by the run's margin.
  std::optional<double> mask_iou;
  /// The share of the true mask that the run's mask covers.
  std::optional<double> mask_recall;
  /// Pixels outside the run's mask that differ from the input; must be 0.
  std::optional<std::size_t> changed_outside;
  /// By pose: "color_from_world", "rgbd0_depth_from_world", "color_from_rgbd0_depth".
  std::map<std::string, PoseError> poses;
};

/// A run compared with its recording's truth.
struct Score {
  std::vector<FrameScore> frames;
  /// The mean over the frames that have the figure; `changed_outside` is the sum, the edges' F1
  /// that of mean recall and precision.
  FrameScore mean;
  /// From the squared error over all frames' pixels inside the true mask.
  std::optional<double> psnr_pooled_db;
  /// The mean absolute change of (result - truth) between consecutive frames inside both true
  /// masks, grey levels.
  std::optional<double> flicker;
  /// Frames of the recording that the run did not write.
  std::vector<std::string> not_written;
};

/// Compares the results in `run` (from `diminish run`) with `recording`/truth. Throws Error if
/// either folder lacks something.
DIMINISH_EXPORT Score score_run(const std::filesystem::path& recording,
                                const std::filesystem::path& run);
/// The same. Also writes run/score/NAME.png, cropped to the object's surroundings: input, result,
/// truth; four times the error, provenance, and the causes of error, each in its colour.
DIMINISH_EXPORT Score score_run_with_pictures(const std::filesystem::path& recording,
                                              const std::filesystem::path& run);

/// For a terminal.
DIMINISH_EXPORT std::string score_table(const Score& score);
DIMINISH_EXPORT std::string score_json(const Score& score);

}  // namespace diminish
