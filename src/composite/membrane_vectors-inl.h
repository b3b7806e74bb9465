// Included once for each instruction set: what the membrane's kernels have in common.
#if defined(DIMINISH_MEMBRANE_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DIMINISH_MEMBRANE_VECTORS_INL_H
#undef DIMINISH_MEMBRANE_VECTORS_INL_H
#else
#define DIMINISH_MEMBRANE_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include <vector>

#include "composite/membrane_level.h"

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

/// The lanes whose bits are set, from bit i on.
HWY_INLINE Mask LoadBits(unsigned bits, std::ptrdiff_t i) {
  alignas(8) std::uint8_t bytes[8] = {};
  bytes[0] = static_cast<std::uint8_t>(bits >> i);
  bytes[1] = static_cast<std::uint8_t>(bits >> (i + 8));
  return hn::LoadMaskBits(Floats(), bytes);
}

/// Calls visit(column) for each block of a row.
template <class Visit>
HWY_INLINE void ForEachBlock(const std::vector<MembraneLevel::Span>& spans,
                             const std::vector<int>& rows, int y, const Visit& visit) {
  const auto row = static_cast<std::size_t>(y / tile_height);
  for (int i = rows[row]; i < rows[row + 1]; ++i) {
    const MembraneLevel::Span span = spans[static_cast<std::size_t>(i)];
    for (int column = span.first; column < span.last; ++column) visit(column);
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

/// Which edges a vector of cells of the finest level has.
struct EdgeMasks {
  Mask left, right, up, down;

  HWY_INLINE EdgeMasks(const std::uint16_t* edges, std::ptrdiff_t i)
      : left(LoadBits(edges[0], i)),
        right(LoadBits(edges[1], i)),
        up(LoadBits(edges[2], i)),
        down(LoadBits(edges[3], i)) {}
  HWY_INLINE Vector Sum(const Neighbours& n) const {
    return hn::Add(hn::Add(hn::IfThenElseZero(left, n.left), hn::IfThenElseZero(right, n.right)),
                   hn::Add(hn::IfThenElseZero(up, n.up), hn::IfThenElseZero(down, n.down)));
  }
  HWY_INLINE Vector Count() const {
    const auto one_if = [](Mask mask) HWY_ATTR { return hn::IfThenElseZero(mask, Set(1.F)); };
    return hn::Add(hn::Add(one_if(left), one_if(right)), hn::Add(one_if(up), one_if(down)));
  }
};

}  // namespace
}  // namespace diminish::membrane::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
