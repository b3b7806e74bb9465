#include "detect/silhouette/polygon_filler.h"

#include <algorithm>
#include <utility>

namespace diminish {
namespace {

std::int64_t divide_down(std::int64_t number, std::int64_t by) {
  return number / by - (number % by < 0 ? 1 : 0);
}

/// An edge, followed down the rows [first_row, last_row) that it crosses.
class Edge {
 public:
  int first_row, last_row;

  Edge(Polygons::Corner a, Polygons::Corner b, int height) {
    if (a.y > b.y) std::swap(a, b);
    first_row = std::clamp(Polygons::row_from(a.y), 0, height);
    last_row = std::clamp(Polygons::row_from(b.y), first_row, height);
    if (first_row == last_row) return;
    const std::int64_t dx = std::int64_t{b.x} - a.x;
    const std::int64_t dy = std::int64_t{b.y} - a.y;
    const std::int64_t row_y = std::int64_t{first_row} * Polygons::subpixels;
    unit_ = dy * Polygons::subpixels;
    const std::int64_t x = a.x * dy + (row_y - a.y) * dx;
    column_ = divide_down(x, unit_);
    rest_ = x - column_ * unit_;
    const std::int64_t step = dx * Polygons::subpixels;
    step_ = divide_down(step, unit_);
    step_rest_ = step - step_ * unit_;
  }

  /// The first column whose centre is at the edge or right of it.
  int column(int width) const {
    return static_cast<int>(std::clamp<std::int64_t>(column_ + (rest_ > 0 ? 1 : 0), 0, width));
  }
  void go_down() {
    column_ += step_;
    rest_ += step_rest_;
    if (rest_ < unit_) return;
    rest_ -= unit_;
    ++column_;
  }

 private:
  // x is (column + rest / unit) pixels.
  std::int64_t column_ = 0, rest_ = 0, unit_ = 1, step_ = 0, step_rest_ = 0;
};

/// Calls visit(edge) for each side of a polygon.
template <class Visit>
void for_each_edge(std::span<const Polygons::Corner> corners, int height, const Visit& visit) {
  const Polygons::Corner* previous = &corners.back();
  for (const Polygons::Corner& corner : corners) {
    visit(Edge(*previous, corner, height));
    previous = &corner;
  }
}

}  // namespace

void PolygonFiller::fill(const Polygons& polygons, Mask& mask, std::span<std::uint8_t> covers) {
  for (std::size_t i = 0; i < polygons.polygons.size(); ++i) {
    const auto [end, object] = polygons.polygons[i];
    const std::uint32_t begin = polygons.begin_of(i);
    const PolygonRows rows(polygons, i, mask.height());
    if (rows.first == rows.last) continue;
    list_columns({polygons.corners.data() + begin, end - begin}, rows, mask.bounds());
    bool any = false;
    for (int row = rows.first; row < rows.last; ++row) {
      any |= fill_row(row - rows.first, mask.row(row));
    }
    if (any) covers[object] = 1;
  }
}

/// Finds where the polygon's edges cross each of its rows.
void PolygonFiller::list_columns(std::span<const Polygons::Corner> corners, const PolygonRows& rows,
                                 const Rect& picture) {
  // First counts the crossings of each row, to reserve a place for each.
  ends_.assign(static_cast<std::size_t>(rows.last - rows.first) + 1, 0);
  const auto end_of = [&](int row) -> int& {
    return ends_[static_cast<std::size_t>(row - rows.first)];
  };
  for_each_edge(corners, picture.height, [&](const Edge& edge) {
    for (int row = edge.first_row; row < edge.last_row; ++row) ++end_of(row + 1);
  });
  for (std::size_t row = 1; row < ends_.size(); ++row) ends_[row] += ends_[row - 1];
  columns_.resize(static_cast<std::size_t>(ends_.back()));
  // Each row's begin is moved to its end.
  for_each_edge(corners, picture.height, [&](Edge edge) {
    for (int row = edge.first_row; row < edge.last_row; ++row) {
      columns_[static_cast<std::size_t>(end_of(row)++)] = edge.column(picture.width);
      edge.go_down();
    }
  });
}

/// row: counted from the polygon's first.
bool PolygonFiller::fill_row(int row, std::uint8_t* pixels) {
  const auto begin = columns_.begin() + (row > 0 ? ends_[static_cast<std::size_t>(row) - 1] : 0);
  const auto end = columns_.begin() + ends_[static_cast<std::size_t>(row)];
  // Nearly all rows have two.
  if (end - begin > 2) {
    std::sort(begin, end);
  } else if (end - begin == 2 && begin[1] < begin[0]) {
    std::swap(begin[0], begin[1]);
  }
  bool any = false;
  for (auto column = begin; end - column >= 2; column += 2) {
    std::fill(pixels + column[0], pixels + column[1], std::uint8_t{255});
    any = any || column[0] < column[1];
  }
  return any;
}

}  // namespace diminish
