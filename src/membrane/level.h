#pragma once

#include <hwy/aligned_allocator.h>

#include <cstddef>
#include <cstdint>
#include <span>
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
/// Its cells lie in tiles of 32 columns and 8 rows; a row of a tile is a block. The even and the
/// odd columns of a row are stored apart (`parity` 0 and 1), so that relaxing every second cell,
/// summing 2x2 cells and interpolating them are plain vector operations. Every array has a margin
/// of one block and one row around it, and weights are zero wherever there is no cell, so that no
/// kernel looks at borders, and empty blocks are not touched at all.
///
/// Far from irregular cells the solution is smooth: such tiles are not relaxed here, but take their
/// values from the next coarser level. Of those that touch an active tile (`ghost`), the blocks
/// right beside it are stored.
struct MembraneLevel {
  static constexpr int tile_width = 32;
  static constexpr int tile_height = 8;
  static constexpr int lanes = tile_width / 2;  ///< cells of one parity in a block
  static constexpr int channels = 3;

  enum class Block : std::uint8_t {
    empty,    ///< no cell
    general,  ///< weights are to be looked up
    plain     ///< all cells, each with four neighbours of weight 1
  };
  enum class Tile : std::uint8_t { empty, smooth, ghost, active };
  /// Blocks [first, last) of a row.
  struct Span {
    int first, last;
  };
  /// Which blocks of each row. The rows of a row of tiles are alike, except for the first two and
  /// the last, where more is stored: what lies below or above active tiles.
  class BlockRows {
   public:
    static constexpr int parts = 3;
    static int part(int y) {
      const int within = y % tile_height;
      return within < 2 ? 0 : within < tile_height - 1 ? 1 : 2;
    }

    void clear();
    /// The runs of columns for which wanted(column) holds, for the next part.
    template <class Wanted>
    void append(int columns, const Wanted& wanted);
    int rows() const { return static_cast<int>(begin_.size() - 1) / parts * tile_height; }
    std::span<const Span> row(int y) const {
      const std::size_t at =
          static_cast<std::size_t>(y / tile_height) * parts + static_cast<std::size_t>(part(y));
      return {spans_.data() + begin_[at], spans_.data() + begin_[at + 1]};
    }

   private:
    std::vector<Span> spans_;
    std::vector<std::size_t> begin_ = {0};
  };

  int width = 0, height = 0;            ///< cells
  int tile_columns = 0, tile_rows = 0;  ///< enough for all cells
  std::ptrdiff_t pitch = 0;             ///< floats of one parity of one row

  AlignedFloats right, down;  ///< weights of the edges to the right and lower neighbours
  AlignedFloats inverse;      ///< 1 / (sum of a cell's weights); -1: fixed (Dirichlet); 0: nothing
  AlignedFloats x, right_side;    ///< three channels: the solution, and what it solves for
  AlignedFloats error, residual;  ///< likewise, of a correction cycle

  bool has_sources = true;  ///< right_side is not 0 everywhere

  std::vector<Block> blocks;  ///< of each row, tile_columns of them
  std::vector<Tile> tiles;    ///< with a margin of one empty tile all around
  BlockRows active, stored;
  bool has_smooth = false;  ///< some tiles are left to the coarser level

  /// A bit for each cell that is not plain, 32 a word; a word's margin on both sides.
  std::vector<std::uint32_t> rough;

  /// Makes room for width x height cells and forgets the last problem.
  void begin(int width, int height);
  /// From the blocks and the rough cells, decides the tiles' states; some are smooth only if they
  /// may be. finer: null on the finest level.
  void choose_tiles(const MembraneLevel* finer, bool may_be_smooth);

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

  int rows() const { return tile_rows * tile_height; }
  std::uint32_t* rough_row(int y) { return rough.data() + rough_index(y); }
  const std::uint32_t* rough_row(int y) const { return rough.data() + rough_index(y); }
  Block& block(int y, int column) { return blocks[block_index(y, column)]; }
  Block block(int y, int column) const { return blocks[block_index(y, column)]; }
  Tile& state(int column, int row) { return tiles[tile_index(column, row)]; }
  Tile state(int column, int row) const { return tiles[tile_index(column, row)]; }

 private:
  std::ptrdiff_t rough_index(int y) const { return std::ptrdiff_t{y} * (tile_columns + 2) + 1; }
  std::size_t block_index(int y, int column) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(tile_columns) +
           static_cast<std::size_t>(column);
  }
  std::size_t tile_index(int column, int row) const {
    return static_cast<std::size_t>(row + 1) * static_cast<std::size_t>(tile_columns + 2) +
           static_cast<std::size_t>(column + 1);
  }
  bool touches_active(int column, int row, int part) const;
  /// Zeroes what the last problem left in the blocks that `is_left` names.
  template <class IsLeft>
  void clear_old(const IsLeft& is_left);
  void clear_block(int y, int column);
  void clear_right_side(int y, int column);

  std::vector<Block> old_blocks_;
  BlockRows old_stored_;
  std::vector<std::uint32_t> gathered_;
  bool old_sources_ = false;
};

}  // namespace diminish
