#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "diminish/frame_source.h"
#include "diminish/marker_detector.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "diminish/scene.h"
#include "setup/check/clock_offset.h"

namespace diminish {

/// The mean length of a marker's four sides.
double mean_side_px(const Marker& marker);

/// What one colour sensor saw.
struct SensorSurvey {
  struct MarkerStatistics {
    std::size_t count = 0;
    std::vector<double> sides_px;   ///< mean side, one value per frame
    std::vector<double> errors_px;  ///< reprojection error of its pose
  };

  std::string name;  ///< "color", "rgbd0 color"
  std::size_t images = 0;
  std::vector<double> brightness;           ///< mean, levels, one value per frame
  std::vector<double> overexposed;          ///< share of pixels
  std::map<int, MarkerStatistics> markers;  ///< those of known size
};

/// What all cameras saw in a recording's frames, in one pass.
struct SetupSurvey {
  struct Kept {
    FrameSet frame;
    Markers markers;
  };

  std::size_t frames = 0;
  double frame_period_s = 0;
  SensorSurvey color;
  std::vector<SensorSurvey> rgbd;
  std::vector<std::size_t> missing;        ///< frames without this RGB-D camera
  std::vector<std::string> first_missing;  ///< the first one's reason
  std::vector<std::string> faults;         ///< the first of them
  std::size_t fault_count = 0;
  std::vector<Kept> kept;
  /// Paths of markers on objects, in the world frame or else in the colour camera's, as the colour
  /// camera and each RGB-D camera saw them, each timed by its own clock.
  std::vector<std::map<int, std::vector<TimedPoint>>> color_ways, rgbd_ways;
  /// Reprojection error between cameras: a marker as the RGB-D camera sees it, projected into the
  /// colour camera's picture, pixels. One value per marker and frame.
  std::vector<std::vector<double>> between_px;
};

/// The reprojection error between two cameras: each marker that both see, as the RGB-D camera's
/// colour sensor sees it, projected into the colour camera's picture; pixels. skip: a marker's id,
/// or -1.
std::vector<double> errors_between(const std::vector<Marker>& in_color,
                                   const std::vector<Marker>& in_rgbd,
                                   const std::map<int, double>& sizes_m, const Lens& color_lens,
                                   const Lens& rgbd_lens, const RigidTransform& color_from_rgbd,
                                   int skip = -1);

/// Reads up to `most_frames` frames; keeps six of them at most.
SetupSurvey survey_setup(const Rig& rig, const Scene& scene, FrameSource& source,
                         std::size_t most_frames);

}  // namespace diminish
