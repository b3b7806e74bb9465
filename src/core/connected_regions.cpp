#include "core/connected_regions.h"

#include <algorithm>

namespace diminish {

void ConnectedRegions::find(const Mask& mask, Pixels pixels, Connectivity connectivity) {
  begin();
  for (int y = 0; y < mask.height(); ++y) {
    diminish::for_each_run(mask.row(y), 0, mask.width(), pixels,
                           [&](int first, int last) { add(y, first, last); });
  }
  connect(connectivity);
}

void ConnectedRegions::number_regions() {
  regions_.clear();
  for (int i = 0; i < static_cast<int>(runs_.size()); ++i) {
    Run& run = runs_[i];
    const int length = run.last - run.first;
    // Runs point to earlier ones, which have their numbers already.
    if (run.region == i) {
      run.region = static_cast<int>(regions_.size());
      regions_.push_back({{run.first, run.y, length, 1}, length, i, i});
      continue;
    }
    run.region = runs_[run.region].region;
    Region& region = regions_[run.region];
    runs_[region.last_run].next = i;
    region.last_run = i;
    const int right = std::max(region.box.right(), run.last);
    region.box.x = std::min(region.box.x, run.first);
    region.box.width = right - region.box.x;
    region.box.height = run.y + 1 - region.box.y;
    region.pixels += length;
  }
}

}  // namespace diminish
