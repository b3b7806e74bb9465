#pragma once

#include <cstdint>
#include <vector>

#include "diminish/image.h"
#include "diminish/options.h"
#include "diminish/rig.h"

namespace diminish {

/// Takes out of an RGB-D camera's depth images what would show wrong things:
/// - flying pixels: measurements on depth edges that lie between the surfaces;
/// - pixels that the camera's own colour sensor, some centimetres beside the depth sensor, does not
///   see because something nearer is in front of them: they would get its colour. (Only where it
///   is beside, not above: sensors are built that way.)
/// and averages what is left over neighbouring pixels of the same surface: seen from the side,
/// noise in depth is noise in place.
class DepthCleaner {
 public:
  explicit DepthCleaner(const RgbdCamera& camera);

  /// Only in `part`; the rest is copied. Cost: 5 ns a pixel.
  void clean(const Image<std::uint16_t>& depth, const Rect& part, const Options& options,
             Image<std::uint16_t>& cleaned);

 private:
  struct Row {
    std::vector<float> depth_m, place;
  };
  void remove_flying(const Image<std::uint16_t>& depth, const Rect& part, int y,
                     Image<std::uint16_t>& cleaned) const;
  void smooth(const Rect& part, Image<std::uint16_t>& cleaned);
  std::uint16_t smoothed(const std::uint16_t* pixel, std::ptrdiff_t step) const;
  void remove_hidden(const Rect& part, int y, float threshold_m, Row& row,
                     Image<std::uint16_t>& cleaned) const;

  RgbdCamera camera_;
  /// A pixel's ray (x, y, 1), turned into the colour sensor's frame: its x and z.
  Image<float> ray_side_, ray_ahead_;
  Row rows_[2];
  Image<std::uint16_t> half_smooth_;
};

}  // namespace diminish
