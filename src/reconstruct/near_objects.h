#pragma once

#include <algorithm>
#include <vector>

#include "core/runs.h"
#include "diminish/image.h"

namespace diminish {

/// Where pixels near objects may be: of each row, one run of columns.
class NearObjects {
 public:
  /// Covers whatever of `region` is at most `reach_px` rows and columns away from `objects`.
  void find(const Mask& objects, const Rect& region, int reach_px) {
    top_ = region.y;
    own_.assign(static_cast<std::size_t>(region.height), none);
    columns_.assign(own_.size(), none);
    for (int y = 0; y < region.height; ++y) {
      Columns& own = own_[static_cast<std::size_t>(y)];
      for_each_run(objects.row(region.y + y), region.x, region.right(), Pixels::set,
                   [&](int first, int last) {
                     own = join(own, {first, last});
                   });
      if (own.first < own.last) {
        own = {std::max(own.first - reach_px, region.x),
               std::min(own.last + reach_px, region.right())};
      }
    }
    for (int y = 0; y < region.height; ++y) {
      const int last = std::min(y + reach_px + 1, region.height);
      for (int near = std::max(0, y - reach_px); near < last; ++near) {
        Columns& columns = columns_[static_cast<std::size_t>(y)];
        columns = join(columns, own_[static_cast<std::size_t>(near)]);
      }
    }
  }

  struct Columns {
    int first, last;  ///< of the picture; nothing if they are not in this order
  };
  /// y: of the picture, in the region.
  const Columns& row(int y) const { return columns_[static_cast<std::size_t>(y - top_)]; }

 private:
  static constexpr Columns none{1 << 30, 0};
  static Columns join(const Columns& a, const Columns& b) {
    return {std::min(a.first, b.first), std::max(a.last, b.last)};
  }

  int top_ = 0;
  std::vector<Columns> own_, columns_;
};

}  // namespace diminish
