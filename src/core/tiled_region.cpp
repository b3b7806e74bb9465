#include "diminish/tiled_region.h"

#include <algorithm>
#include <cstring>

namespace diminish {
namespace {

/// Of a tile's pixels, or some of them.
bool is_any_set(const Mask& mask, const Rect& part) {
  std::uint64_t any = 0;
  if (part.width == TiledRegion::tile) {
    std::uint64_t pixels[2];
    static_assert(sizeof(pixels) == TiledRegion::tile);
    for (int y = part.y; y < part.bottom(); ++y) {
      std::memcpy(pixels, mask.row(y) + part.x, sizeof(pixels));
      any |= pixels[0] | pixels[1];
    }
    return any != 0;
  }
  for (int y = part.y; y < part.bottom(); ++y) {
    const std::uint8_t* const row = mask.row(y);
    for (int x = part.x; x < part.right(); ++x) any |= row[x];
  }
  return any != 0;
}

}  // namespace

void TiledRegion::begin_tiles() {
  first_column_ = x / tile;
  first_row_ = y / tile;
  columns_ = (right() - 1) / tile - first_column_ + 1;
  rows_ = (bottom() - 1) / tile - first_row_ + 1;
  kept_.assign(index(0, rows_), 0);
}

void TiledRegion::keep_near(const Mask& objects, int distance_px) {
  if (empty()) return;
  begin_tiles();
  const Rect tiles{0, 0, columns_, rows_};
  const int reach = (distance_px + tile - 1) / tile;
  for (int row = 0; row < rows_; ++row) {
    const int last = std::min(bottom(), (first_row_ + row + 1) * tile);
    for (int column = 0; column < columns_; ++column) {
      const int left = std::max(x, (first_column_ + column) * tile);
      const int end = std::min(right(), (first_column_ + column + 1) * tile);
      const int top = std::max(y, (first_row_ + row) * tile);
      if (!is_any_set(objects, {left, top, end - left, last - top})) continue;
      const Rect near = intersect(grow({column, row, 1, 1}, reach), tiles);
      for (int k = near.y; k < near.bottom(); ++k) {
        std::fill_n(kept_.begin() + static_cast<std::ptrdiff_t>(index(near.x, k)), near.width,
                    std::uint8_t{1});
      }
    }
  }
  add_up();
}

void TiledRegion::add_up() {
  sums_.assign(static_cast<std::size_t>(columns_ + 1) * static_cast<std::size_t>(rows_ + 1), 0);
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      sum(column + 1, row + 1) = kept_[index(column, row)] + sum(column, row + 1) +
                                 sum(column + 1, row) - sum(column, row);
    }
  }
}

bool TiledRegion::touches(const Rect& pixels) const {
  const Rect part = intersect(*this, pixels);
  if (part.empty() || is_whole()) return !part.empty();
  const int left = part.x / tile - first_column_;
  const int top = part.y / tile - first_row_;
  const int end = (part.right() - 1) / tile - first_column_ + 1;
  const int below = (part.bottom() - 1) / tile - first_row_ + 1;
  return sum(end, below) - sum(left, below) - sum(end, top) + sum(left, top) > 0;
}

}  // namespace diminish
