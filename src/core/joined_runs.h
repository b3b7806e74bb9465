#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "core/runs.h"
#include "diminish/image.h"

namespace diminish {

/// Columns [first, last) of a row.
struct ColumnRun {
  int first, last;
};

/// What some runs of a row cover together. Fast where most of them overlap.
class JoinedRuns {
 public:
  void clear() { runs_.clear(); }
  void add(const ColumnRun& run) {
    for (ColumnRun& other : runs_) {
      if (run.first > other.last || other.first > run.last) continue;
      other = {std::min(run.first, other.first), std::max(run.last, other.last)};
      return;
    }
    runs_.push_back(run);
  }
  /// In any order. They may overlap.
  const std::vector<ColumnRun>& runs() const { return runs_; }
  /// From left to right, apart from each other.
  const std::vector<ColumnRun>& in_order() {
    std::sort(runs_.begin(), runs_.end(),
              [](const ColumnRun& a, const ColumnRun& b) { return a.first < b.first; });
    std::size_t count = 0;
    for (const ColumnRun& run : runs_) {
      if (count > 0 && run.first <= runs_[count - 1].last) {
        runs_[count - 1].last = std::max(runs_[count - 1].last, run.last);
      } else {
        runs_[count++] = run;
      }
    }
    runs_.resize(count);
    return runs_;
  }

 private:
  std::vector<ColumnRun> runs_;
};

/// The runs of a part of a mask.
class MaskRuns {
 public:
  /// pixels: which the runs consist of. Rows and columns are the mask's.
  void find(ImageView<std::uint8_t> mask, const Rect& part, Pixels pixels) {
    part_ = part;
    runs_.clear();
    row_begin_.clear();
    for (int y = part.y; y < part.bottom(); ++y) {
      row_begin_.push_back(runs_.size());
      for_each_run(mask.row(y), part.x, part.right(), pixels, [&](int first, int last) {
        runs_.push_back({first, last});
      });
    }
    row_begin_.push_back(runs_.size());
  }
  /// Calls visit(run, rows) for the runs of row y and of up to `reach` rows above and below; rows:
  /// how far away.
  template <class Visit>
  void for_each_near(int y, int reach, const Visit& visit) const {
    const int last = std::min(part_.bottom() - 1, y + reach);
    for (int row = std::max(part_.y, y - reach); row <= last; ++row) {
      const std::size_t* const begin = &row_begin_[static_cast<std::size_t>(row - part_.y)];
      for (std::size_t i = begin[0]; i < begin[1]; ++i) visit(runs_[i], std::abs(row - y));
    }
  }

 private:
  Rect part_;
  std::vector<ColumnRun> runs_;
  std::vector<std::size_t> row_begin_;  ///< in `runs_`: of the part's rows, and the end
};

}  // namespace diminish
