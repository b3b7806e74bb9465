#include "composite/membrane_level.h"

#include <algorithm>
#include <utility>

#include "core/rows.h"

namespace diminish {
namespace {

/// The runs of tiles for which `wanted` holds, row by row.
template <class Wanted>
void collect(const MembraneLevel& level, Wanted wanted, std::vector<MembraneLevel::Span>& spans,
             std::vector<int>& rows) {
  spans.clear();
  rows.clear();
  for (int row = 0; row < level.tile_rows; ++row) {
    rows.push_back(static_cast<int>(spans.size()));
    for (int column = 0; column < level.tile_columns; ++column) {
      if (!wanted(level.state(column, row))) continue;
      const int first = column;
      while (column < level.tile_columns && wanted(level.state(column, row))) ++column;
      spans.push_back({first, column});
    }
  }
  rows.push_back(static_cast<int>(spans.size()));
}

/// More than needed, so that the next frame's window, a little larger or smaller, is laid out in
/// the same way, and only what changes has to be cleared.
int tiles_for(int cells, int tile) {
  constexpr int at_a_time = 4;
  const int needed = (cells + tile - 1) / tile;
  return (needed + at_a_time - 1) / at_a_time * at_a_time;
}

}  // namespace

void AlignedFloats::require(std::size_t count) {
  if (count <= capacity_) return;
  capacity_ = count + count / 4;
  data_ = hwy::AllocateAligned<float>(capacity_);
  std::fill_n(data_.get(), capacity_, 0.F);
}

void MembraneLevel::begin(int width_, int height_) {
  const int columns = tiles_for(width_, tile_width);
  const int tiles_high = tiles_for(height_, tile_height);
  std::swap(blocks, old_blocks_);
  std::swap(stored, old_stored_);
  std::swap(stored_rows, old_stored_rows_);
  old_sources_ = has_sources;
  if (columns != tile_columns || tiles_high != tile_rows) {
    // Everything will be elsewhere.
    clear_old([](int, int) { return true; });
    old_stored_rows_.clear();
  }
  width = width_;
  height = height_;
  tile_columns = columns;
  tile_rows = tiles_high;
  pitch = (tile_columns + 2) * lanes;
  const std::size_t size =
      static_cast<std::size_t>(rows() + 2) * 2 * static_cast<std::size_t>(pitch);
  for (AlignedFloats* values : {&right, &down, &inverse}) values->require(size);
  for (AlignedFloats* values : {&x, &right_side, &error, &residual}) {
    values->require(size * channels);
  }
  blocks.assign(static_cast<std::size_t>(rows()) * static_cast<std::size_t>(tile_columns),
                Block::empty);
  tiles.assign(static_cast<std::size_t>(tile_rows + 2) * static_cast<std::size_t>(tile_columns + 2),
               Tile::empty);
}

template <class IsLeft>
void MembraneLevel::clear_old(const IsLeft& is_left) {
  const int count = static_cast<int>(old_stored_rows_.size()) - 1;
  for_rows(std::max(count, 0) * tile_height, [&](Rows part) {
    for (int row = part.first / tile_height; row < part.last / tile_height; ++row) {
      const auto from = static_cast<std::size_t>(old_stored_rows_[static_cast<std::size_t>(row)]);
      const auto to = static_cast<std::size_t>(old_stored_rows_[static_cast<std::size_t>(row) + 1]);
      for (std::size_t i = from; i < to; ++i) {
        for (int y = row * tile_height; y < (row + 1) * tile_height; ++y) {
          for (int column = old_stored_[i].first; column < old_stored_[i].last; ++column) {
            if (old_blocks_[block_index(y, column)] == Block::empty) continue;
            if (is_left(y, column)) {
              clear_block(y, column);
            } else if (old_sources_) {
              clear_right_side(y, column);
            }
          }
        }
      }
    }
  });
}

void MembraneLevel::clear_block(int y, int column) {
  for (int parity = 0; parity < 2; ++parity) {
    for (AlignedFloats* values : {&right, &down, &inverse}) {
      std::fill_n(values->data() + at(y, parity, column), lanes, 0.F);
    }
    for (int channel = 0; channel < channels; ++channel) {
      std::fill_n(error.data() + at(y, channel, parity, column), lanes, 0.F);
    }
  }
  clear_right_side(y, column);
}

void MembraneLevel::clear_right_side(int y, int column) {
  for (int parity = 0; parity < 2; ++parity) {
    for (int channel = 0; channel < channels; ++channel) {
      std::fill_n(right_side.data() + at(y, channel, parity, column), lanes, 0.F);
    }
  }
}

void MembraneLevel::spread(Tile from, Tile to) {
  for (int row = 0; row < tile_rows; ++row) {
    for (int column = 0; column < tile_columns; ++column) {
      if (state(column, row) != Tile::smooth) continue;
      bool beside = false;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) beside |= state(column + dx, row + dy) == from;
      }
      if (beside) state(column, row) = to;
    }
  }
}

void MembraneLevel::choose_tiles(bool may_be_smooth) {
  for (int row = 0; row < tile_rows; ++row) {
    for (int column = 0; column < tile_columns; ++column) {
      int plain = 0;
      int empty = 0;
      for (int y = row * tile_height; y < (row + 1) * tile_height; ++y) {
        plain += block(y, column) == Block::plain ? 1 : 0;
        empty += block(y, column) == Block::empty ? 1 : 0;
      }
      const bool smooth = may_be_smooth && plain == tile_height;
      state(column, row) = empty == tile_height ? Tile::empty
                           : smooth             ? Tile::smooth
                                                : Tile::active;
    }
  }
  // Through `ghost`, so that a tile made active does not make its own neighbours active.
  spread(Tile::active, Tile::ghost);
  std::replace(tiles.begin(), tiles.end(), Tile::ghost, Tile::active);
  spread(Tile::active, Tile::ghost);
  has_smooth = std::any_of(tiles.begin(), tiles.end(), [](Tile state) {
    return state == Tile::smooth || state == Tile::ghost;
  });
  collect(
      *this, [](Tile state) { return state == Tile::active; }, active, active_rows);
  collect(
      *this, [](Tile state) { return state == Tile::active || state == Tile::ghost; }, stored,
      stored_rows);
  // The rest is going to be overwritten.
  clear_old([this](int y, int column) {
    const Tile tile = state(column, y / tile_height);
    const bool is_stored = tile == Tile::active || tile == Tile::ghost;
    return !is_stored || block(y, column) == Block::empty;
  });
}

}  // namespace diminish
