#pragma once

#include <cstdint>
#include <vector>

#include "core/connected_regions.h"
#include "detect/color_blob/color_table.h"
#include "diminish/image.h"

namespace diminish {

/// Which parts of a picture may show an object of some colour at all, from one sample in many
/// pixels. Keeps its memory from one picture to the next.
class CandidateWindows {
 public:
  struct Limits {
    int core, neighbor;  ///< of ColorTable's entries
    double fewest_core;  ///< samples within `core` that a part must have
    int margin;          ///< added to each side of a part, in samples
    double margin_part;  ///< and this part of its larger extent
  };

  /// The windows around the connected regions of samples within the neighbour limit that have
  /// enough within the core limit; no two overlap. A sample is the mean of two pixels beside each
  /// other in the middle of `pitch` x `pitch` pixels.
  /// Windows are counted in samples.
  const std::vector<Rect>& find(ImageView<Bgr> image, const ColorTable& table, int pitch,
                                const Limits& limits);

 private:
  void take_samples(ImageView<Bgr> image, const ColorTable& table, int pitch, const Limits& limits);
  void join_overlapping();

  Mask candidates_, joined_, scratch_;
  Mask core_;  ///< 1 or 0
  ConnectedRegions regions_;
  std::vector<int> core_samples_;  ///< of each region
  std::vector<Rect> windows_;
};

}  // namespace diminish
