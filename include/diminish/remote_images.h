#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "diminish/export.h"
#include "diminish/image.h"
#include "diminish/occlusion_masks.h"
#include "diminish/options.h"
#include "diminish/poses.h"
#include "diminish/tiled_region.h"

namespace diminish {

/// A depth pixel of a remote RGB-D camera that lies on a surface: what SceneSampler would read
/// there.
struct GlancePoint {
  std::uint16_t column = 0, row = 0;  ///< in the depth image
  bool has_color = false;             ///< the colour image shows it, away from its border
  Bgr color;                          ///< averaged over the neighbourhood
  bool even = false;                  ///< the neighbourhood has a single colour
  /// The colour image's brightness there, for each of Glance::spacings_px; less than 0 where the
  /// image ends.
  std::array<float, 3> brightness{-1, -1, -1};
};

/// What a remote camera's machine tells of a moment's two images before it draws them: all that
/// poses, planes and colours are found from.
struct Glance {
  double color_stamp_s = 0, depth_stamp_s = 0;  ///< as the frame's
  std::vector<Marker> markers;                  ///< in the colour image
  std::array<int, 3> spacings_px{};             ///< of the pixels that `brightness` averages
  std::vector<GlancePoint> points;              ///< row by row, some of a grid
  int point_step_px = 1;                        ///< from one column or row of it to the next
  std::vector<Rect> depth_parts;                ///< of the depth image, around the markers
  /// The depth image at `points` and in `depth_parts`; 0 elsewhere.
  Image<std::uint16_t> depth;
};

/// How a remote camera's images are to be drawn.
struct RemoteDrawing {
  const RigidTransform& color_from_depth;  ///< from its depth sensor to the user's colour camera
  const Mask& rgbd_color;                  ///< the objects to remove, in its colour sensor
  const Mask& rgbd_depth;                  ///< and in its depth sensor
  const TiledRegion& region;               ///< the part of the user's picture
  const Options& options;
};

/// What a remote camera sees of the user's view, without the objects.
struct RemoteLayer {
  Rect region;             ///< the images' place in the user's picture
  Image<Bgr> color;        ///< unspecified where nothing is seen
  Image<float> inverse_z;  ///< 1 / z in the colour camera's frame, in 1/m; 0: nothing is seen
  /// Pixels of the camera's colour image for each of the picture, by the cells of ConfidenceGrid; 0
  /// where the cell's corners are not all drawn.
  Image<float> resolution;
};

/// Two images of one moment that stay on the machine that their camera is plugged into (`diminish
/// render-node`).
class DIMINISH_EXPORT RemoteImages {
 public:
  virtual ~RemoteImages() = default;

  virtual const Glance& glance() const = 0;
  /// Asks for them to be drawn. Does not wait.
  virtual void draw(const RemoteDrawing& drawing) = 0;
  /// Waits for what was asked for last. Null if it did not come in time. The result stays valid as
  /// long as this.
  virtual const RemoteLayer* layer() = 0;
  /// Why a layer did not come, in plain words; empty if all did that were asked for.
  virtual const std::string& problem() const = 0;
};

}  // namespace diminish
