#pragma once

#include <optional>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// How much moved in a camera's picture at a time.
struct MotionSample {
  double stamp_s = 0;  ///< halfway between two images
  double amount = 0;   ///< mean absolute difference of brightness, levels
};

/// Compares each image with the one before, reduced to some hundred pixels a side.
class MotionMeter {
 public:
  /// Nothing for the first image.
  std::optional<MotionSample> add(ImageView<Bgr> image, double stamp_s);

 private:
  Image<std::uint8_t> last_, thinned_;
  double last_stamp_s_ = 0;
};

struct SyncOffset {
  double offset_s = 0;     ///< second clock minus first clock at the same moment
  double correlation = 0;  ///< of the two signals at that offset, up to 1
};

/// The time shift at which two cameras' motion agrees best: the peak of the normalised
/// cross-correlation, to a fraction of a frame. Both in the order of time. Nothing if too little
/// moves or the motions differ. Cost: 0.1 ms per second of signal and 0.1 s of `largest_s`.
std::optional<SyncOffset> estimate_sync_offset(const std::vector<MotionSample>& first,
                                               const std::vector<MotionSample>& second,
                                               double largest_s = 0.5);

}  // namespace diminish
