#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/runs.h"
#include "diminish/image.h"

namespace diminish {

/// Which pixels are neighbours: those that share a side (four), or those that share a side or a
/// corner (eight).
enum class Connectivity { four, eight };

/// Finds the connected regions of a set of pixels by uniting the runs of neighbouring rows. Reuses
/// its memory. Cost: one pass over the pixels and two over their runs.
class ConnectedRegions {
 public:
  /// The pixels [first, last) of row y.
  struct Run {
    int y, first, last;
    int region;  ///< index in `regions()`
    int next;    ///< index in `runs()` of the region's next run; -1: this is the last one
  };
  struct Region {
    Rect box;
    int pixels;
    int first_run, last_run;  ///< indices in `runs()`
  };

  /// Finds the regions of a mask's pixels that are set, or clear.
  void find(const Mask& mask, Pixels pixels, Connectivity connectivity);

  /// Does the same for runs that the caller knows: call `begin`, `add` each run, then `connect`.
  /// Runs come by row, then from left to right. Runs in a row must not touch each other.
  void begin() { runs_.clear(); }
  void add(int y, int first, int last) { runs_.push_back({y, first, last, 0, -1}); }
  void connect(Connectivity connectivity);

  /// By row, then from left to right.
  const std::vector<Run>& runs() const { return runs_; }
  /// In the order of their first runs.
  const std::vector<Region>& regions() const { return regions_; }

  /// The leftmost pixel of a region's highest row.
  Eigen::Vector2i first_pixel(const Region& region) const {
    return {runs_[region.first_run].first, region.box.y};
  }
  /// Calls visit(run) for each of a region's runs, in the order of `runs()`.
  template <class Visit>
  void for_each_run(const Region& region, const Visit& visit) const {
    for (int i = region.first_run; i >= 0; i = runs_[i].next) visit(runs_[i]);
  }

 private:
  void unite(int a, int b);
  int root(int run);
  void number_regions();

  std::vector<Run> runs_;  ///< while they are united, `region` is another run of the region
  std::vector<Region> regions_;
};

}  // namespace diminish
