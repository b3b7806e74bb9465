#pragma once

#include <Eigen/Core>
#include <algorithm>
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
  /// Runs come by row, then from left to right. Runs in a row must not touch each other, unless
  /// their regions are to be four-connected.
  void begin() { runs_.clear(); }
  void add(int y, int first, int last) { runs_.push_back({y, first, last, 0, -1}); }
  void connect(Connectivity connectivity) {
    connect(connectivity, [](const Run&, const Run&) { return true; });
  }
  /// joins(above, below): whether two runs that are neighbours belong together.
  template <class Joins>
  void connect(Connectivity connectivity, const Joins& joins);

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
  void unite(int a, int b) {
    a = root(a);
    b = root(b);
    runs_[std::max(a, b)].region = std::min(a, b);
  }
  int root(int run) {
    while (runs_[run].region != run) {
      runs_[run].region = runs_[runs_[run].region].region;
      run = runs_[run].region;
    }
    return run;
  }
  void number_regions();

  std::vector<Run> runs_;  ///< while they are united, `region` is another run of the region
  std::vector<Region> regions_;
};

template <class Joins>
void ConnectedRegions::connect(Connectivity connectivity, const Joins& joins) {
  const int reach = connectivity == Connectivity::eight ? 1 : 0;
  const int count = static_cast<int>(runs_.size());
  int above = 0;  // the next run in the row above that may touch
  for (int row = 0; row < count;) {
    const int y = runs_[row].y;
    const int above_end = row > 0 && runs_[row - 1].y == y - 1 ? row : above;
    int i = row;
    for (; i < count && runs_[i].y == y; ++i) {
      Run& run = runs_[i];
      run.region = i;
      while (above < above_end && runs_[above].last + reach <= run.first) ++above;
      for (int k = above; k < above_end && runs_[k].first < run.last + reach; ++k) {
        if (joins(runs_[k], run)) unite(i, k);
      }
    }
    above = row;
    row = i;
  }
  number_regions();
}

}  // namespace diminish
