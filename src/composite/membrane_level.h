#pragma once

#include <hwy/aligned_allocator.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace diminish {

/// Memory for vector instructions; grows, never shrinks, and is zero when it is new.
class AlignedFloats {
 public:
  void require(std::size_t count);
  float* data() { return data_.get(); }
  const float* data() const { return data_.get(); }

 private:
  hwy::AlignedFreeUniquePtr<float[]> data_;
  std::size_t capacity_ = 0;
};

/// One grid of MembraneSolver's hierarchy.
///
/// Its cells lie in tiles of 32 columns and 16 rows; a row of a tile is a block. The even and the
/// odd columns of a row are stored apart (`parity` 0 and 1), so that relaxing every second cell,
/// summing 2x2 cells and interpolating them are plain vector operations. Every array has a margin
/// of one block and one row around it, and weights are zero wherever there is no cell, so that no
/// kernel looks at borders, and empty blocks are not touched at all.
///
/// Far from irregular cells the solution is smooth: such tiles are not relaxed here, but take their
/// values from the next coarser level. Those that touch an active tile (`ghost`) are stored.
struct MembraneLevel {
  static constexpr int tile_width = 32;
  static constexpr int tile_height = 16;
  static constexpr int lanes = tile_width / 2;  ///< cells of one parity in a block
  static constexpr int channels = 3;

  enum class Block : std::uint8_t {
    empty,    ///< no cell
    general,  ///< weights are to be looked up
    plain     ///< all cells, each with four neighbours of weight 1
  };
  enum class Tile : std::uint8_t { empty, smooth, ghost, active };
  /// Tiles [first, last) of one row of tiles.
  struct Span {
    int first, last;
  };

  int width = 0, height = 0;            ///< cells
  int tile_columns = 0, tile_rows = 0;  ///< enough for all cells
  std::ptrdiff_t pitch = 0;             ///< floats of one parity of one row

  AlignedFloats right, down;  ///< weights of the edges to the right and lower neighbours
  AlignedFloats inverse;      ///< 1 / (sum of a cell's weights); -1: fixed (Dirichlet); 0: nothing
  AlignedFloats x, right_side;    ///< three channels: the solution, and what it solves for
  AlignedFloats error, residual;  ///< likewise, of a correction cycle

  /// Only on the finest level, where all weights are 0 or 1: a bit for each cell of one parity of a
  /// block, for its left, right, upper and lower edge. A sixteenth of what the weights take.
  std::vector<std::uint16_t> edges;
  bool has_sources = true;  ///< right_side is not 0 everywhere

  std::vector<Block> blocks;                  ///< of each row, tile_columns of them
  std::vector<Tile> tiles;                    ///< with a margin of one empty tile all around
  std::vector<Span> active, stored;           ///< stored: active or ghost
  std::vector<int> active_rows, stored_rows;  ///< where each row of tiles begins in them
  bool has_smooth = false;                    ///< some tiles are left to the coarser level

  /// Makes room for width x height cells and forgets the last problem.
  void begin(int width, int height);
  /// From the blocks, decides the tiles' states; some are smooth only if they may be.
  void choose_tiles(bool may_be_smooth);

  /// Where a block's cells of one parity begin in arrays of one value a cell, and of three.
  std::ptrdiff_t at(int y, int parity, int column) const {
    return (2 * (y + 1) + parity) * pitch + std::ptrdiff_t{lanes} * (column + 1);
  }
  std::ptrdiff_t at(int y, int channel, int parity, int column) const {
    return (2 * (channels * (y + 1) + channel) + parity) * pitch +
           std::ptrdiff_t{lanes} * (column + 1);
  }
  /// Where one cell is in them.
  std::ptrdiff_t cell_at(int column, int y) const {
    return at(y, column % 2, column / tile_width) + column % tile_width / 2;
  }
  std::ptrdiff_t cell_at(int column, int y, int channel) const {
    return at(y, channel, column % 2, column / tile_width) + column % tile_width / 2;
  }
  std::ptrdiff_t row_step() const { return 2 * pitch; }
  std::ptrdiff_t channel_step() const { return 2 * pitch; }
  std::ptrdiff_t channel_row_step() const { return 2 * pitch * channels; }

  std::uint16_t* edges_at(int y, int parity, int column) {
    return edges.data() + 4 * (2 * block_index(y, column) + static_cast<std::size_t>(parity));
  }
  const std::uint16_t* edges_at(int y, int parity, int column) const {
    return edges.data() + 4 * (2 * block_index(y, column) + static_cast<std::size_t>(parity));
  }
  int rows() const { return tile_rows * tile_height; }
  Block& block(int y, int column) { return blocks[block_index(y, column)]; }
  Block block(int y, int column) const { return blocks[block_index(y, column)]; }
  Tile& state(int column, int row) { return tiles[tile_index(column, row)]; }
  Tile state(int column, int row) const { return tiles[tile_index(column, row)]; }

 private:
  std::size_t block_index(int y, int column) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(tile_columns) +
           static_cast<std::size_t>(column);
  }
  std::size_t tile_index(int column, int row) const {
    return static_cast<std::size_t>(row + 1) * static_cast<std::size_t>(tile_columns + 2) +
           static_cast<std::size_t>(column + 1);
  }
  void spread(Tile from, Tile to);
  /// Zeroes what the last problem left in the blocks that `is_left` names.
  template <class IsLeft>
  void clear_old(const IsLeft& is_left);
  void clear_block(int y, int column);
  void clear_right_side(int y, int column);

  std::vector<Block> old_blocks_;
  std::vector<Span> old_stored_;
  std::vector<int> old_stored_rows_;
  bool old_sources_ = false;
};

}  // namespace diminish
