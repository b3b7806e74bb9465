#pragma once

#include "core/connected_regions.h"
#include "detect/difference/object_evidence.h"
#include "diminish/image.h"

namespace diminish {

/// From the pixels' evidence to regions.
class ObjectRegions {
 public:
  /// Leaves out regions that are small, or mostly guessed, and closes small holes. evidence: before
  /// what is unknown was filled in; shown: after.
  void find(const Image<Shown>& evidence, const Image<Shown>& shown, Mask& regions);

 private:
  void fill(const ConnectedRegions::Region& region, std::uint8_t value, Mask& regions) const;

  ConnectedRegions connected_;
};

/// Sets the pixels of `mask` that a small mask's outline, smoothed, contains. shrinkage: of the
/// small mask. Returns whether there are any.
bool add_enlarged(const Mask& small, int shrinkage, Mask& mask);

}  // namespace diminish
