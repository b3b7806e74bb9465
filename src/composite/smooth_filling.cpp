#include "composite/smooth_filling.h"

#include <algorithm>

namespace diminish {
namespace {

/// Forwards and backwards, of each grid but the finest, for which one is enough.
constexpr int relaxations = 2;

}  // namespace

void SmoothFilling::Grid::begin(int width, int height) {
  cells.resize(width + 2, height + 2, 0);
  places.assign(1, {});
  colors.assign(1, Color::Zero());
  open = 0;
}

void SmoothFilling::Grid::relax(std::size_t cell) {
  const Neighbours& own = neighbours[cell];
  if (own.inverse_count == 0) return;
  Color sum = Color::Zero();
  for (const int number : own.at) sum += colors[static_cast<std::size_t>(number)];
  colors[cell] = own.inverse_count * sum;
}

void SmoothFilling::begin(int width, int height) {
  finest().begin(width, height);
}

/// A cell is known if it holds a known one, and has the mean of their colours; else open.
void SmoothFilling::coarsen(const Grid& fine, Grid& coarse) {
  coarse.begin((fine.cells.width() - 1) / 2, (fine.cells.height() - 1) / 2);
  constexpr int becomes_known = -1;
  for (std::size_t i = fine.open + 1; i < fine.places.size(); ++i) {
    const Place place = coarser(fine.places[i]);
    coarse.cells(place.x, place.y) = becomes_known;
  }
  for (std::size_t i = 1; i <= fine.open; ++i) {
    const Place place = coarser(fine.places[i]);
    if (coarse.cells(place.x, place.y) == 0) coarse.add(place);
  }
  coarse.open = coarse.places.size() - 1;
  for (std::size_t i = fine.open + 1; i < fine.places.size(); ++i) {
    const Place place = coarser(fine.places[i]);
    const int& number = coarse.cells(place.x, place.y);
    if (number == becomes_known) coarse.add(place);
    coarse.colors[static_cast<std::size_t>(number)] += fine.colors[i];
  }
  for (std::size_t i = coarse.open + 1; i < coarse.places.size(); ++i) {
    coarse.colors[i] /= coarse.colors[i][3];
  }
  coarse.find_neighbours([](Place) { return 0; });
}

/// Bilinear, of the cells that are there.
void SmoothFilling::interpolate(const Grid& coarse, Grid& fine) {
  for (std::size_t i = 1; i <= fine.open; ++i) {
    const auto [x, y] = fine.places[i];
    const auto [column, row] = coarser({x, y});
    const int beside_x = x % 2 == 0 ? column + 1 : column - 1;
    const int beside_y = y % 2 == 0 ? row + 1 : row - 1;
    const Color sum = 9 * coarse.color(column, row) +
                      3 * (coarse.color(beside_x, row) + coarse.color(column, beside_y)) +
                      coarse.color(beside_x, beside_y);
    fine.colors[i] = sum / sum[3];
  }
}

void SmoothFilling::solve() {
  std::size_t count = 1;
  while (grids_[count - 1].open > 0) {
    if (grids_.size() == count) grids_.emplace_back();
    coarsen(grids_[count - 1], grids_[count]);
    ++count;
  }
  for (std::size_t l = count - 1; l-- > 0;) {
    Grid& grid = grids_[l];
    interpolate(grids_[l + 1], grid);
    for (int k = 0; k < (l == 0 ? 1 : relaxations); ++k) {
      for (std::size_t i = 1; i <= grid.open; ++i) grid.relax(i);
      for (std::size_t i = grid.open; i > 0; --i) grid.relax(i);
    }
  }
}

}  // namespace diminish
