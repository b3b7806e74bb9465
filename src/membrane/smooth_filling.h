#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/rows.h"
#include "diminish/image.h"
#include "membrane/filling_rows.h"

namespace diminish {

/// Colours for a set of open pixels that pass smoothly from one known pixel beside them to the
/// next: nearly the solution of Laplace's equation, at a fraction of its cost (MembraneSolver).
///
/// Cascadic multigrid (Bornemann & Deuflhard 1996): from the coarsest grid to the finest, each
/// starts from what the coarser one found, and is relaxed a few times; there is no way back. A
/// coarse cell that holds a known pixel is known, and has the mean of their colours. Relaxation is
/// in red-black order, by Chebyshev's factors (Golub & Varga 1961): half as many sweeps do. Which
/// pixels a cell holds, and which cells are red, goes by the place in the picture, and does not
/// change where the set grows. Work is done on runs of open cells, so that ragged sets cost what
/// they hold and not what they span.
///
/// Use: begin, set the kinds, connect, solve, for_each_run.
class SmoothFilling {
 public:
  /// What a pixel is. A coarse cell is the greatest of what it holds.
  using Kind = std::uint8_t;
  static constexpr Kind absent = 0, open = 1, known = 2;

  /// How often half the cells of a grid, first the red ones, are relaxed; and by which factors.
  struct Relaxation {
    int half_sweeps;
    float spectral_radius;  ///< as large as Jacobi's iteration is taken to have

    /// Of half sweep k: 1, then up to 2.
    float factor(int k) const;
  };
  static constexpr Relaxation finest = {4, 0.95F};
  static constexpr Relaxation coarser = {6, 0.99F};
  static constexpr int most_half_sweeps = 6;

  /// Starts with new pixels. box: holds all open ones; in the picture.
  /// Returns the kinds of the box's pixels and of a rim of one pixel around it, all of which are to
  /// be set. Open: none of the rim. Known: lends its colour if it is beside an open one.
  Image<Kind>& begin(const Rect& box);
  /// color(x, y), an Eigen::Array3f: that of a known pixel beside an open one; asked once of each.
  /// Returns whether there is any.
  template <class GetColor>
  bool connect(const GetColor& color) {
    Grid& grid = grids_.front();
    grid.find_open();
    grid.find_known();
    for (const Place place : grid.known) {
      const Eigen::Array3f channels = color(place.x, place.y);
      grid.color_row(place.y)[place.x] = {channels[0], channels[1], channels[2], 1};
    }
    return !grid.known.empty();
  }
  /// All open pixels get a colour, those that hang together with no known one, too.
  /// There must be a known pixel.
  void solve();
  /// Calls visit(y, first, last, colors) for each run of open pixels, columns [first, last) of row
  /// y; colors[x]: the channels, and 1. They may overshoot the known colours a little.
  template <class Visit>
  void for_each_run(const Visit& visit) const {
    const Grid& grid = grids_.front();
    for (int y = grid.box.y; y < grid.box.bottom(); ++y) {
      for (const Run run : grid.runs_of(y)) visit(y, run.first, run.last, grid.color_row(y));
    }
  }

 private:
  using Color = filling_rows::Color;
  struct Place {
    int x, y;
  };
  using Run = filling_rows::Run;

  struct Grid {
    Rect box;  ///< of the open cells; the images have a rim of 1 around it
    Image<Kind> kinds;
    Image<Color> colors;
    std::vector<Run> runs;               ///< of open cells
    std::vector<std::size_t> row_begin;  ///< in `runs`: of the box's rows, and the end
    std::vector<Place> known;            ///< known cells
    // Scratch, by band of rows.
    Image<Kind> next_kinds;
    std::vector<Place> known_in_band[most_bands];
    std::vector<Kind> row_in_band[most_bands];

    void begin(const Rect& open_box);
    /// To be indexed by x.
    Color* color_row(int y) { return colors.row(y - box.y + 1) - (box.x - 1); }
    const Color* color_row(int y) const { return colors.row(y - box.y + 1) - (box.x - 1); }
    void find_open();
    void find_known();
    /// None beyond the box.
    std::span<const Run> runs_of(int y) const {
      if (y < box.y || y >= box.bottom()) return {};
      const std::size_t* const begin = &row_begin[static_cast<std::size_t>(y - box.y)];
      return {runs.data() + begin[0], runs.data() + begin[1]};
    }
    /// To be the coarser grid.
    void coarsen(const Grid& fine);
    void interpolate_row(const Grid& coarse, int y);
    void relax_row(int y, int parity, float factor);
    int shared_rows() const;
    void refine(const Grid& coarse, const Relaxation& relaxation);
  };

  std::vector<Grid> grids_ = std::vector<Grid>(1);
};

}  // namespace diminish
