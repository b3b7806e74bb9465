#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "diminish/export.h"
#include "diminish/image.h"

namespace diminish {

/// A part of the picture: a rectangle, or those of its tiles that are near an object. (The bounding
/// box of a slender object is mostly empty.)
class DIMINISH_EXPORT TiledRegion : public Rect {
 public:
  static constexpr int tile = 16;  ///< pixels; tiles begin at multiples of it

  TiledRegion() = default;
  /// The whole rectangle.
  TiledRegion(const Rect& box) : Rect(box) {}
  /// Becomes the whole rectangle. Keeps its memory.
  void set(const Rect& box) {
    Rect::operator=(box);
    first_column_ = first_row_ = columns_ = rows_ = 0;
    kept_.clear();
    sums_.clear();
  }

  /// Removes tiles that are further than `distance_px`, rounded up to whole tiles, from every tile
  /// with a part of an object.
  void keep_near(const Mask& objects, int distance_px);

  /// Removes tiles for which `keeps` is false. keeps: of a tile's pixels, those outside the
  /// rectangle too.
  template <class Keeps>
  void keep_if(const Keeps& keeps) {
    if (empty()) return;
    begin_tiles();
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        const Rect pixels{(first_column_ + column) * tile, (first_row_ + row) * tile, tile, tile};
        kept_[index(column, row)] = keeps(pixels) ? 1 : 0;
      }
    }
    add_up();
  }

  /// The tiles that overlap the rectangle, counted from the picture's first tile; and row by row
  /// whether each is kept, empty if all are.
  Rect tiles() const { return {first_column_, first_row_, columns_, rows_}; }
  const std::vector<std::uint8_t>& kept_tiles() const { return kept_; }

  /// Whether all tiles belong to it.
  bool is_whole() const { return kept_.empty(); }
  /// Whether a pixel of the rectangle belongs to it.
  bool keeps(int column, int row) const {
    return is_whole() || kept_[index(column / tile - first_column_, row / tile - first_row_)] != 0;
  }
  /// Whether any of `pixels` belongs to it. Cost: that of a single pixel.
  bool touches(const Rect& pixels) const;
  /// Calls visit(first, last) for each run [first, last) of columns in a row of the rectangle that
  /// do not belong to it.
  template <class Visit>
  void for_each_gap(int row, const Visit& visit) const {
    if (is_whole()) return;
    for (int first = x; first < right();) {
      int last = first;
      while (last < right() && !keeps(last, row)) last = (last / tile + 1) * tile;
      if (last > first) visit(first, std::min(last, right()));
      while (last < right() && keeps(last, row)) last = (last / tile + 1) * tile;
      first = last;
    }
  }
  /// The same for those that do.
  template <class Visit>
  void for_each_run(int row, const Visit& visit) const {
    int begin = x;
    for_each_gap(row, [&](int first, int last) {
      if (first > begin) visit(begin, first);
      begin = last;
    });
    if (begin < right()) visit(begin, right());
  }

 private:
  /// Keeps none.
  void begin_tiles();
  void add_up();
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  std::int32_t& sum(int column, int row) {
    return sums_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_ + 1) +
                 static_cast<std::size_t>(column)];
  }
  std::int32_t sum(int column, int row) const {
    return const_cast<TiledRegion*>(this)->sum(column, row);
  }

  int first_column_ = 0, first_row_ = 0, columns_ = 0, rows_ = 0;  ///< of the tiles
  std::vector<std::uint8_t> kept_;                                 ///< by tile; empty: all
  std::vector<std::int32_t> sums_;  ///< of kept tiles above and left of each corner
};

}  // namespace diminish
