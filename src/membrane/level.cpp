#include "membrane/level.h"

#include <algorithm>
#include <utility>

#include "core/rows.h"

namespace diminish {
namespace {

/// Cells within this distance of irregular ones are not smooth.
constexpr int margin = 4;

/// More than needed, so that the next frame's window, a little larger or smaller, has the same
/// layout and only changes have to be cleared.
int tiles_for(int cells, int tile) {
  constexpr int at_a_time = 4;
  const int needed = (cells + tile - 1) / tile;
  return (needed + at_a_time - 1) / at_a_time * at_a_time;
}

}  // namespace

void MembraneLevel::BlockRows::clear() {
  spans_.clear();
  begin_.assign(1, 0);
}

template <class Wanted>
void MembraneLevel::BlockRows::append(int columns, const Wanted& wanted) {
  for (int column = 0; column < columns; ++column) {
    if (!wanted(column)) continue;
    const int first = column;
    while (column < columns && wanted(column)) ++column;
    spans_.push_back({first, column});
  }
  begin_.push_back(spans_.size());
}

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
  old_sources_ = has_sources;
  if (columns != tile_columns || tiles_high != tile_rows) {
    // Everything will be elsewhere.
    clear_old([](int, int) { return true; });
    old_stored_.clear();
  }
  width = width_;
  height = height_;
  tile_columns = columns;
  tile_rows = tiles_high;
  pitch = std::ptrdiff_t{lanes} * (tile_columns + 2);
  const std::size_t size =
      static_cast<std::size_t>(rows() + 2) * 2 * static_cast<std::size_t>(pitch);
  for (AlignedFloats* values : {&right, &down, &inverse}) values->require(size);
  for (AlignedFloats* values : {&x, &right_side, &error, &residual}) {
    values->require(size * channels);
  }
  blocks.assign(static_cast<std::size_t>(rows()) * static_cast<std::size_t>(tile_columns),
                Block::empty);
  rough.assign(static_cast<std::size_t>(rows()) * static_cast<std::size_t>(tile_columns + 2), 0U);
  tiles.assign(static_cast<std::size_t>(tile_rows + 2) * static_cast<std::size_t>(tile_columns + 2),
               Tile::empty);
}

template <class IsLeft>
void MembraneLevel::clear_old(const IsLeft& is_left) {
  for_rows(old_stored_.rows(), [&](Rows part) {
    for (int y = part.first; y < part.last; ++y) {
      for (const Span span : old_stored_.row(y)) {
        for (int column = span.first; column < span.last; ++column) {
          if (old_blocks_[block_index(y, column)] == Block::empty) continue;
          if (is_left(y, column)) {
            clear_block(y, column);
          } else if (old_sources_) {
            clear_right_side(y, column);
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

bool MembraneLevel::touches_active(int column, int row, int part) const {
  const int above = part == 0 ? -1 : 0;
  const int below = part == BlockRows::parts - 1 ? 1 : 0;
  for (int dy = above; dy <= below; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (state(column + dx, row + dy) == Tile::active) return true;
    }
  }
  return false;
}

void MembraneLevel::choose_tiles(const MembraneLevel* finer, bool may_be_smooth) {
  const auto is_left_by_finer = [&](int column, int row) {
    if (!finer || column >= finer->tile_columns || row >= finer->tile_rows) return true;
    const Tile tile = finer->state(column, row);
    return tile == Tile::smooth || tile == Tile::empty;
  };
  gathered_.resize(static_cast<std::size_t>(tile_columns) + 2);
  for (int row = 0; row < tile_rows; ++row) {
    const int top = row * tile_height;
    std::fill(gathered_.begin(), gathered_.end(), 0U);
    for (int y = std::max(top - margin, 0); y < std::min(top + tile_height + margin, height); ++y) {
      const std::uint32_t* cells = rough_row(y) - 1;
      for (std::size_t i = 0; i < gathered_.size(); ++i) gathered_[i] |= cells[i];
    }
    for (int column = 0; column < tile_columns; ++column) {
      const std::uint32_t* cells = gathered_.data() + column + 1;
      const bool near_rough =
          (cells[0] | cells[-1] >> (tile_width - margin) | cells[1] << (tile_width - margin)) != 0;
      int plain = 0;
      int empty = 0;
      for (int y = top; y < top + tile_height; ++y) {
        plain += block(y, column) == Block::plain ? 1 : 0;
        empty += block(y, column) == Block::empty ? 1 : 0;
      }
      const bool smooth = may_be_smooth && plain == tile_height && !near_rough &&
                          is_left_by_finer(2 * column, 2 * row) &&
                          is_left_by_finer(2 * column + 1, 2 * row) &&
                          is_left_by_finer(2 * column, 2 * row + 1) &&
                          is_left_by_finer(2 * column + 1, 2 * row + 1);
      state(column, row) = empty == tile_height ? Tile::empty
                           : smooth             ? Tile::smooth
                                                : Tile::active;
    }
  }
  has_smooth = false;
  active.clear();
  stored.clear();
  for (int row = 0; row < tile_rows; ++row) {
    for (int column = 0; column < tile_columns; ++column) {
      if (state(column, row) != Tile::smooth) continue;
      has_smooth = true;
      if (touches_active(column, row, 0) || touches_active(column, row, 2)) {
        state(column, row) = Tile::ghost;
      }
    }
    for (int part = 0; part < BlockRows::parts; ++part) {
      const auto is_active = [&](int column) { return state(column, row) == Tile::active; };
      active.append(tile_columns, is_active);
      stored.append(tile_columns, [&](int column) {
        return is_active(column) ||
               (state(column, row) == Tile::ghost && touches_active(column, row, part));
      });
    }
  }
  // The rest will be overwritten.
  clear_old([this](int y, int column) {
    const auto spans = stored.row(y);
    const bool is_stored = std::any_of(spans.begin(), spans.end(), [&](Span span) {
      return column >= span.first && column < span.last;
    });
    return !is_stored || block(y, column) == Block::empty;
  });
}

}  // namespace diminish
