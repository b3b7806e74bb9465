#pragma once

#include <cstdint>
#include <vector>

#include "core/joined_runs.h"
#include "diminish/image.h"

namespace diminish {

/// Grows masks by discs.
class DiscDilation {
 public:
  /// Sets every pixel of `mask` at most `radius` pixels (Euclidean, between centres) from a
  /// non-zero pixel to 255, and the others to 0.
  void dilate(Mask& mask, int radius) { dilate(mask, bounding_box(mask), radius); }
  /// Likewise. part: outside of which nothing is set.
  void dilate(Mask& mask, const Rect& part, int radius);

  /// Fills gaps and holes that a disc of `radius` pixels does not fit in: dilation, then erosion.
  void close(Mask& mask, int radius);

 private:
  void copy_part(const Mask& mask, const Rect& part);
  void spread_runs(const Rect& part, int radius, Pixels pixels, std::uint8_t value, Mask& target);

  Mask before_;
  MaskRuns runs_;                 ///< of what was before
  JoinedRuns joined_;             ///< of a row of the target
  std::vector<int> half_widths_;  ///< of the disc's rows, from its middle on
};

}  // namespace diminish
