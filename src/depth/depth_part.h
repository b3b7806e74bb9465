#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/rows.h"
#include "diminish/image.h"

namespace diminish {

/// A part of a depth image: in each row, a range of columns.
class DepthPart {
 public:
  /// Columns [first, last).
  struct Columns {
    int first = 0, last = 0;

    int count() const { return last - first; }
  };

  DepthPart() = default;
  /// All of the rectangle.
  DepthPart(const Rect& all)
      : bounds_(all), band_(std::max(1, all.bottom())), columns_{{all.x, all.right()}} {}

  /// Starts empty. The image's rows are added in bands of this height.
  void begin(int band_height) {
    bounds_ = {};
    band_ = band_height;
    columns_.clear();
  }
  /// Adds the columns of the next band, which ends before row `end`; none if the range is empty.
  void add_band(const Columns& columns, int end) {
    const int first = static_cast<int>(columns_.size()) * band_;
    columns_.push_back(columns);
    bounds_ = join(bounds_, {columns.first, first, columns.count(), end - first});
  }

  /// Becomes all that is at most `margin` rows and columns away from another part, and a few pixels
  /// more, in an image of this size.
  void grow_from(const DepthPart& part, int margin, const Rect& image) {
    begin(grown_band);
    const int first_row = part.bounds_.y - margin;
    const int last_row = std::min(part.bounds_.bottom() + margin, image.bottom());
    for (int y = 0; y < last_row; y += grown_band) {
      Columns all;
      if (y + grown_band > first_row) {
        all = part.columns_between(y - margin, y + grown_band + margin);
      }
      if (all.count() > 0) {
        all = {std::max(all.first - margin, 0), std::min(all.last + margin, image.right())};
      }
      add_band(all, std::min(y + grown_band, image.bottom()));
    }
  }
  /// Of the rows [first, last), those in `bounds`.
  Columns columns_between(int first, int last) const {
    Columns all;
    for (int y = std::max(first, bounds_.y); y < std::min(last, bounds_.bottom()); ++y) {
      const Columns& own = columns(y);
      if (own.count() <= 0) continue;
      all = all.count() <= 0
                ? own
                : Columns{std::min(all.first, own.first), std::max(all.last, own.last)};
    }
    return all;
  }

  /// All columns lie inside this rectangle.
  const Rect& bounds() const { return bounds_; }
  /// Of a row of `bounds`.
  const Columns& columns(int y) const { return columns_[static_cast<std::size_t>(y / band_)]; }

 private:
  static constexpr int grown_band = 8;

  Rect bounds_;
  int band_ = 1;
  std::vector<Columns> columns_;  ///< by band
};

/// Calls visit(y, columns) for each row in the intersection of part and rectangle; bands
/// of rows are shared by threads.
template <class Visit>
void for_each_row(const DepthPart& part, const Rect& rectangle, const Visit& visit) {
  const Rect bounds = intersect(part.bounds(), rectangle);
  for_rows(bounds.height, [&](Rows rows) {
    for (int y = bounds.y + rows.first; y < bounds.y + rows.last; ++y) {
      const DepthPart::Columns& all = part.columns(y);
      const DepthPart::Columns columns{std::max(all.first, bounds.x),
                                       std::min(all.last, bounds.right())};
      if (columns.count() > 0) visit(y, columns);
    }
  });
}

}  // namespace diminish
