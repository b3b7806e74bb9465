#include "detect/polygon_filler.h"

namespace diminish {
namespace {

/// The first column whose centre is at an edge, or right of it, in a row that it crosses.
int first_column(Polygons::Corner a, Polygons::Corner b, std::int64_t row_y) {
  if (a.y > b.y) std::swap(a, b);
  const std::int64_t height = std::int64_t{b.y} - a.y;
  const std::int64_t x = a.x * height + (row_y - a.y) * (std::int64_t{b.x} - a.x);
  const std::int64_t unit = height * Polygons::subpixels;
  return static_cast<int>(x / unit + (x % unit > 0 ? 1 : 0));
}

}  // namespace

void PolygonFiller::fill(const Polygons& polygons, Mask& mask, std::span<std::uint8_t> covers) {
  for (std::size_t i = 0; i < polygons.polygons.size(); ++i) {
    const auto [end, object] = polygons.polygons[i];
    const std::uint32_t begin = polygons.begin_of(i);
    const std::span corners(polygons.corners.data() + begin, end - begin);
    const PolygonRows rows(polygons, i, mask.height());
    bool any = false;
    for (int row = rows.first; row < rows.last; ++row) any |= fill_row(corners, row, mask);
    if (any) covers[object] = 1;
  }
}

bool PolygonFiller::fill_row(std::span<const Polygons::Corner> corners, int row, Mask& mask) {
  columns_.clear();
  const int row_y = row * Polygons::subpixels;
  const Polygons::Corner* previous = &corners.back();
  for (const Polygons::Corner& corner : corners) {
    if ((previous->y <= row_y) != (corner.y <= row_y)) {
      columns_.push_back(std::clamp(first_column(*previous, corner, row_y), 0, mask.width()));
    }
    previous = &corner;
  }
  std::sort(columns_.begin(), columns_.end());
  bool any = false;
  for (std::size_t i = 0; i + 1 < columns_.size(); i += 2) {
    std::fill(mask.row(row) + columns_[i], mask.row(row) + columns_[i + 1], std::uint8_t{255});
    any = any || columns_[i] < columns_[i + 1];
  }
  return any;
}

}  // namespace diminish
