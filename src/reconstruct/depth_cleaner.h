#pragma once

#include <cstdint>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/image.h"
#include "diminish/options.h"
#include "diminish/rig.h"

namespace diminish {

/// Takes out of an RGB-D camera's depth images what would show wrong things:
/// - pixels that the camera's own colour sensor, some centimetres beside the depth sensor, does not
///   see because something nearer is in front of them: they would get its colour;
/// - flying pixels: measurements on depth edges that lie between the surfaces.
class DepthCleaner {
 public:
  explicit DepthCleaner(const RgbdCamera& camera);

  void clean(const Image<std::uint16_t>& depth, const Options& options,
             Image<std::uint16_t>& cleaned);

 private:
  struct Row {
    std::vector<float> depth_m, place;
  };
  void remove_hidden(int y, float threshold_m, Row& row, Image<std::uint16_t>& cleaned) const;
  void remove_flying(const Image<std::uint16_t>& depth, int y,
                         Image<std::uint16_t>& cleaned) const;

  RgbdCamera camera_;
  Image<Eigen::Vector2f> rays_;
  Row rows_[2];
};

}  // namespace diminish
