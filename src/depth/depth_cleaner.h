#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/rows.h"
#include "depth/depth_part.h"
#include "depth/depth_rows.h"
#include "depth/depth_smoothing.h"
#include "depth/edge_snapping.h"
#include "diminish/image.h"
#include "diminish/options.h"
#include "diminish/rig.h"
#include "geometry/ray_table.h"

namespace diminish {

/// Cleans an RGB-D camera's depth images. Removes what would look wrong:
/// - flying pixels: measurements on depth edges that lie between the surfaces;
/// - pixels that the camera's own colour sensor, some centimetres beside the depth sensor, cannot
///   see because something nearer hides them: they would get its colour. (Only for sensors side by
///   side, not one above the other: cameras are built that way.)
/// Then takes the noise out of surfaces (DepthSmoothing) and moves depth edges onto the colour
/// image's (EdgeSnapping).
class DepthCleaner {
 public:
  explicit DepthCleaner(const RgbdCamera& camera);

  /// images: masked parts are not used to move edges. Changes only `part` and copies the rest.
  /// Cost: 1 ns per pixel, plus DepthSmoothing's and EdgeSnapping's.
  void clean(ImageView<std::uint16_t> depth, const EdgeSnapping::Images& images,
             const DepthPart& part, const Options& options, Image<std::uint16_t>& cleaned);

 private:
  struct Scratch {
    std::vector<float> depth_m, place;
  };
  void remove_flying(ImageView<std::uint16_t> depth, const DepthPart& part,
                     Image<std::uint16_t>& cleaned) const;
  void remove_hidden(const DepthPart& part, float threshold_m, Image<std::uint16_t>& cleaned);
  void smooth(ImageView<std::uint16_t> depth, const DepthPart& part, bool without_flying,
              Image<std::uint16_t>& cleaned);
  depth_rows::Row row(ImageView<std::uint16_t> depth, int y,
                      const DepthPart::Columns& columns) const;

  RgbdCamera camera_;
  std::shared_ptr<const RayTable> rays_;
  Scratch scratch_[most_bands];
  DepthSmoothing smoothing_;
  DepthPart around_;
  Image<std::uint16_t> given_;  ///< to be smoothed
  EdgeSnapping edge_snapping_;
};

}  // namespace diminish
