#pragma once

#include <cstdint>
#include <vector>

#include "depth/depth_part.h"
#include "depth/depth_rows.h"
#include "depth/edge_snapping.h"
#include "diminish/image.h"
#include "diminish/options.h"
#include "diminish/rig.h"

namespace diminish {

/// Takes out of an RGB-D camera's depth images what would show wrong things:
/// - flying pixels: measurements on depth edges that lie between the surfaces;
/// - pixels that the camera's own colour sensor, some centimetres beside the depth sensor, does not
///   see because something nearer is in front of them: they would get its colour. (Only where it
///   is beside, not above: sensors are built that way.)
/// averages what is left over neighbouring pixels of the same surface (seen from the side, noise in
/// depth is noise in place), and moves its edges onto the colour image's (EdgeSnapping).
class DepthCleaner {
 public:
  explicit DepthCleaner(const RgbdCamera& camera);

  /// images: what is masked in them is not used to move edges. Only in `part`; the rest is copied.
  /// Cost: 1 ns a pixel, besides EdgeSnapping's.
  void clean(const Image<std::uint16_t>& depth, const EdgeSnapping::Images& images,
             const DepthPart& part, const Options& options, Image<std::uint16_t>& cleaned);

 private:
  struct Scratch {
    std::vector<float> depth_m, place;
  };
  void remove_flying(const Image<std::uint16_t>& depth, const DepthPart& part,
                     Image<std::uint16_t>& cleaned) const;
  void remove_hidden(const DepthPart& part, float threshold_m, Image<std::uint16_t>& cleaned);
  void smooth(const DepthPart& part, Image<std::uint16_t>& cleaned);
  depth_rows::Row row(const Image<std::uint16_t>& depth, int y,
                      const DepthPart::Columns& columns) const;

  RgbdCamera camera_;
  /// A pixel's ray (x, y, 1), turned into the colour sensor's frame: its x and z.
  Image<float> ray_side_, ray_ahead_;
  Scratch scratch_[2];  ///< of each thread
  Image<std::uint16_t> half_smooth_;
  EdgeSnapping edge_snapping_;
};

}  // namespace diminish
