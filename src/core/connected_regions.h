#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/runs.h"
#include "diminish/image.h"

namespace diminish {

/// Four: pixels that share a side are neighbours. Eight: or a corner.
enum class Connectivity { four, eight };

/// The connected regions of a set of pixels, found by uniting the runs of neighbouring rows. Keeps
/// its memory from one set to the next. Cost: one pass over the pixels, one over their runs.
class ConnectedRegions {
 public:
  /// The pixels [first, last) of row y.
  struct Run {
    int y, first, last;
    int region;  ///< index in `regions()`
    int next;    ///< index in `runs()` of the region's next one; -1: it is the last
  };
  struct Region {
    Rect box;
    int pixels;
    int first_run, last_run;  ///< indices in `runs()`
  };

  /// Of a mask's pixels.
  void find(const Mask& mask, Pixels pixels, Connectivity connectivity);

  /// The same of runs that are given one by one: `begin`, `add` each, `connect`. By row, then from
  /// left to right; two runs of a row must not touch.
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
