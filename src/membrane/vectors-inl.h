// Included once for each instruction set: helpers for the membrane's kernels.
#if defined(DIMINISH_MEMBRANE_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DIMINISH_MEMBRANE_VECTORS_INL_H
#undef DIMINISH_MEMBRANE_VECTORS_INL_H
#else
#define DIMINISH_MEMBRANE_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include "membrane/level.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::membrane::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int lanes = MembraneLevel::lanes;
constexpr int tile_height = MembraneLevel::tile_height;
constexpr int channels = MembraneLevel::channels;
using Floats = hn::CappedTag<float, lanes>;
using Vector = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;
using Block = MembraneLevel::Block;
using Tile = MembraneLevel::Tile;

HWY_INLINE std::ptrdiff_t VectorSize() {
  return static_cast<std::ptrdiff_t>(hn::Lanes(Floats()));
}

HWY_INLINE Vector Load(const float* from) {
  return hn::LoadU(Floats(), from);
}

HWY_INLINE void Store(Vector vector, float* to) {
  hn::StoreU(vector, Floats(), to);
}

HWY_INLINE Vector Set(float value) {
  return hn::Set(Floats(), value);
}

HWY_INLINE Vector Zero() {
  return hn::Zero(Floats());
}

/// Calls visit(column) for each block of a row.
template <class Visit>
HWY_INLINE void ForEachBlock(const MembraneLevel::BlockRows& rows, int y, const Visit& visit) {
  for (const MembraneLevel::Span span : rows.row(y)) {
    for (int column = span.first; column < span.last; ++column) visit(column);
  }
}

/// Calls visit(kind, first, last) for each run of blocks of the same kind, unless they are empty.
template <class Visit>
HWY_INLINE void ForEachRun(const MembraneLevel& level, const MembraneLevel::BlockRows& rows, int y,
                           const Visit& visit) {
  for (const MembraneLevel::Span span : rows.row(y)) {
    for (int column = span.first; column < span.last;) {
      const Block kind = level.block(y, column);
      const int first = column;
      while (column < span.last && level.block(y, column) == kind) ++column;
      if (kind != Block::empty) visit(kind, first, column);
    }
  }
}

HWY_INLINE void Fill(float value, float* even, std::ptrdiff_t pitch) {
  for (int parity = 0; parity < 2; ++parity) {
    for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
      Store(Set(value), even + parity * pitch + i);
    }
  }
}

/// Sorts a block's cells by parity.
HWY_INLINE void StoreApart(const float* cells, float* even, std::ptrdiff_t pitch) {
  for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
    Vector first, second;
    hn::LoadInterleaved2(Floats(), cells + 2 * i, first, second);
    Store(first, even + i);
    Store(second, even + pitch + i);
  }
}

HWY_INLINE Tile StateOf(const MembraneLevel& level, int y, int column) {
  return y < level.rows() && column < level.tile_columns ? level.state(column, y / tile_height)
                                                         : Tile::empty;
}

HWY_INLINE Mask IsFixed(Vector inverse) {
  return hn::Lt(inverse, Zero());
}

/// The weights of a vector of cells of one parity. Their horizontal neighbours have the other.
struct Weights {
  Vector left, right, up, down;

  HWY_INLINE Weights(const MembraneLevel& level, int y, int parity, int column, std::ptrdiff_t i) {
    const std::ptrdiff_t own = level.at(y, parity, column) + i;
    const std::ptrdiff_t other = level.at(y, 1 - parity, column) + i;
    left = Load(level.right.data() + other - 1 + parity);
    right = Load(level.right.data() + own);
    up = Load(level.down.data() + own - level.row_step());
    down = Load(level.down.data() + own);
  }
  HWY_INLINE Vector Total() const { return hn::Add(hn::Add(left, right), hn::Add(up, down)); }
};

/// The neighbours' values of a vector of cells.
struct Neighbours {
  Vector left, right, up, down;

  HWY_INLINE Neighbours(const MembraneLevel& level, const float* values, std::ptrdiff_t own,
                        int parity) {
    const float* other = values + own + (parity == 0 ? level.pitch : -level.pitch);
    left = Load(other - 1 + parity);
    right = Load(other + parity);
    up = Load(values + own - level.channel_row_step());
    down = Load(values + own + level.channel_row_step());
  }
  HWY_INLINE Vector Total() const { return hn::Add(hn::Add(left, right), hn::Add(up, down)); }
  HWY_INLINE Vector Weighted(const Weights& weights, Vector right_side) const {
    return hn::MulAdd(
        weights.left, left,
        hn::MulAdd(weights.right, right,
                   hn::MulAdd(weights.up, up, hn::MulAdd(weights.down, down, right_side))));
  }
};

}  // namespace
}  // namespace diminish::membrane::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
