#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/connected_regions.h"
#include "membrane/coarsest.h"
#include "membrane/level.h"

namespace diminish {

/// Pixels [first, last) of row y.
struct LooseRun {
  int y, first, last;
};

/// Laplace's equation with sources on any set of pixels, three channels at a time,
///
///   sum over neighbours q of p (x_p - x_q)  =  source_p
///
/// where a neighbour is another pixel of the set or one of given value (Dirichlet); any other does
/// not count (Neumann).
/// Solved by full multigrid (Brandt 1977) on cell-centred grids with red-black relaxation. Away
/// from boundaries, where the solution is smooth, the finer grids are left out and their values
/// interpolated (the idea of Agarwala 2007), so that the cost of large regions follows their
/// outline.
///
/// Use: begin, fill `keys`, connect, set_fixed and add_source, solve, read_block.
class MembraneSolver {
 public:
  static constexpr int channels = MembraneLevel::channels;
  using Values = float[channels];

  /// Starts a problem inside a window of this size.
  void begin(int width, int height);
  /// The key of a pixel whose value is given.
  static constexpr std::uint8_t fixed = 255;

  /// A row's keys, one a pixel; to be filled. 0: nothing (a free border), `fixed`: a Dirichlet
  /// value; others: a pixel to solve for. Those with a neighbour of another key are irregular.
  std::uint8_t* keys(int y) { return keys_.data() + key_index(y); }
  const std::uint8_t* keys(int y) const { return keys_.data() + key_index(y); }

  /// Reads the keys.
  void connect();
  /// Calls visit(x, y) for each fixed pixel that has a neighbour to solve for: set_fixed it.
  template <class Visit>
  void for_each_fixed(const Visit& visit) const {
    for_each_pixel(fixed_, visit);
  }
  template <class Visit>
  void for_each_irregular(const Visit& visit) const {
    for_each_pixel(irregular_, visit);
  }
  void set_fixed(int x, int y, const Values& value);
  /// Adds to the right side of an irregular pixel.
  void add_source(int x, int y, const Values& value);

  /// Takes the connected parts that touch no fixed pixel out of the problem, which leaves them
  /// open, and returns them; to be called before sources are added.
  const std::vector<LooseRun>& take_out_loose_parts();

  /// Solves until the last correction's root mean square is below `tolerance`.
  void solve(float tolerance);

  /// The solution in the pixels [32 * column, 32 * column + 32) of row y; `result` holds three
  /// channels of 32. Unspecified where there is no pixel of the set.
  void read_block(int y, int column, float* result) const;

  /// Which of these pixels are of the set, a bit each.
  std::uint32_t cells_in_block(int y, int column) const {
    return cells_[static_cast<std::size_t>(word_index(y) + column)];
  }
  /// The number of pixels to solve for.
  std::size_t size() const { return size_; }
  /// Cycles on the finest grid that the last problem took.
  int cycles() const { return cycles_; }

 private:
  /// A fixed value or a source.
  struct Boundary {
    int x, y;
    float value[channels];
  };

  template <class Visit>
  void for_each_pixel(const std::vector<std::uint32_t>& words, const Visit& visit) const {
    for (int y = 0; y < height_; ++y) {
      const std::uint32_t* row = words.data() + word_index(y);
      for (int word = 0; word < tile_columns_; ++word) {
        for_each_bit(row[word], [&](int bit) { visit(word * MembraneLevel::tile_width + bit, y); });
      }
    }
  }

  void build();
  void coarsen_blocks(const MembraneLevel& fine, MembraneLevel& coarse) const;
  /// Specks weigh too little in a root mean square to be noticed when multigrid is not done with
  /// them: those that take_out_loose_parts left are relaxed one by one.
  void relax_small_parts(float tolerance);
  /// Returns the largest change of a channel.
  float relax_pixel(int x, int y);
  /// from_zero: of the error, else of x. Returns the squared change.
  double cycle(std::size_t level, bool from_zero);

  std::ptrdiff_t key_index(int y) const {
    return (y + 1) * keys_per_row_ + MembraneLevel::tile_width;
  }
  std::ptrdiff_t word_index(int y) const { return (y + 1) * words_per_row_ + 1; }

  int width_ = 0, height_ = 0, tile_columns_ = 0;
  std::ptrdiff_t keys_per_row_ = 0, words_per_row_ = 0;
  std::vector<std::uint8_t> keys_;
  std::vector<std::uint32_t> cells_, fixed_, irregular_;
  std::size_t size_ = 0;
  std::vector<Boundary> sources_, fixed_values_;
  ConnectedRegions parts_;
  std::vector<bool> held_;  ///< of each part; none: they were not looked for
  std::vector<LooseRun> loose_;
  std::vector<MembraneLevel> levels_;
  std::size_t level_count_ = 0;
  MembraneCoarsest coarsest_;
  int cycles_ = 0;
};

}  // namespace diminish
