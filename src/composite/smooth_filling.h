#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <iterator>
#include <vector>

#include "composite/neighbours.h"
#include "diminish/image.h"

namespace diminish {

/// Colours for a set of open pixels that pass smoothly from one known pixel beside them to the
/// next: nearly the solution of Laplace's equation, at a fraction of its cost (MembraneSolver).
///
/// Cascadic multigrid (Bornemann & Deuflhard 1996): from the coarsest grid to the finest, each
/// starts from what the coarser one found, and is relaxed a few times; there is no way back. Cells
/// that hold a known pixel have its colour. Grids are lists of cells, so that ragged sets cost what
/// they hold and not what they span.
///
/// Use: begin, open all pixels, connect, solve, for_each.
class SmoothFilling {
 public:
  /// Starts with no pixels, in a window of this size.
  void begin(int width, int height);
  /// Adds a pixel to fill. Row by row, each once.
  void open(int x, int y) {
    finest().add({x + 1, y + 1});
    ++finest().open;
  }
  bool empty() const { return grids_.front().open == 0; }
  /// is_known(x, y): whether that pixel, which is not open, lends its colour; asked of all pixels
  /// beside open ones, outside the window, too. color(x, y): that colour, asked once a pixel.
  /// Returns whether there is any known pixel.
  template <class IsKnown, class GetColor>
  bool connect(const IsKnown& is_known, const GetColor& color) {
    Grid& grid = finest();
    grid.find_neighbours([&](Place place) {
      if (!is_known(place.x - 1, place.y - 1)) return 0;
      const int number = grid.add(place);
      const Eigen::Array3f channels = color(place.x - 1, place.y - 1);
      grid.colors.back() = {channels[0], channels[1], channels[2], 1};
      return number;
    });
    return grid.places.size() > grid.open + 1;
  }
  /// All open pixels get a colour, those that hang together with no known one, too.
  /// There must be a known pixel.
  void solve();
  /// Calls visit(x, y, color) for each open pixel; color: within the known colours.
  template <class Visit>
  void for_each(const Visit& visit) const {
    const Grid& grid = grids_.front();
    for (std::size_t i = 1; i <= grid.open; ++i) {
      visit(grid.places[i].x - 1, grid.places[i].y - 1, grid.colors[i]);
    }
  }

 private:
  /// The channels, and 1; all 0 for what is not there, so that sums count their terms.
  using Color = Eigen::Array4f;
  struct Place {
    int x, y;
  };
  /// The left one last: relaxing forwards, it is the one that was just computed.
  static constexpr PixelOffset beside[] = {{0, -1}, {0, 1}, {1, 0}, {-1, 0}};

  struct Grid {
    /// Each cell's number; 0: not in the grid. With a rim of 1 around the window.
    Image<int> cells;
    // By number; 0 is nothing, 1 to `open` are open, the others known.
    std::vector<Place> places;
    std::vector<Color> colors;
    std::size_t open = 0;
    struct Neighbours {
      int at[4];
      float inverse_count;
    };
    std::vector<Neighbours> neighbours;  ///< of the open cells

    void begin(int width, int height);
    /// With color 0. Returns its number.
    int add(Place place) {
      const auto number = static_cast<int>(places.size());
      cells(place.x, place.y) = number;
      places.push_back(place);
      colors.emplace_back(0.F, 0.F, 0.F, 0.F);
      return number;
    }
    const Color& color(int x, int y) const { return colors[static_cast<std::size_t>(cells(x, y))]; }
    /// take_in(place): the number of a cell beside an open one that is not in the grid; it may add
    /// the cell, or return 0.
    template <class TakeIn>
    void find_neighbours(const TakeIn& take_in) {
      neighbours.resize(open + 1);
      for (std::size_t i = 1; i <= open; ++i) {
        const Place place = places[i];
        Neighbours& own = neighbours[i];
        int count = 0;
        for (std::size_t k = 0; k < std::size(beside); ++k) {
          const Place other{place.x + beside[k].x, place.y + beside[k].y};
          own.at[k] = cells(other.x, other.y);
          if (own.at[k] == 0) own.at[k] = take_in(other);
          count += own.at[k] != 0 ? 1 : 0;
        }
        own.inverse_count = count > 0 ? 1 / static_cast<float>(count) : 0;
      }
    }
    void relax(std::size_t cell);
  };

  static Place coarser(Place place) { return {(place.x + 1) / 2, (place.y + 1) / 2}; }
  static void coarsen(const Grid& fine, Grid& coarse);
  static void interpolate(const Grid& coarse, Grid& fine);
  Grid& finest() { return grids_.front(); }

  std::vector<Grid> grids_ = std::vector<Grid>(1);
};

}  // namespace diminish
