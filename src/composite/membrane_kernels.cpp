#include "composite/membrane_kernels.h"

#include <algorithm>

#include "composite/neighbours.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "composite/membrane_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

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

using Bytes = hn::CappedTag<std::uint8_t, 16>;

HWY_INLINE unsigned Bits(hn::Mask<Bytes> mask) {
  alignas(8) std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Bytes(), mask, bits);
  const unsigned unused = 32 - static_cast<unsigned>(hn::Lanes(Bytes()));
  return static_cast<unsigned>(bits[0] | (bits[1] << 8)) << unused >> unused;
}

void ClassifyRow(const std::uint8_t* keys, std::ptrdiff_t keys_per_row, int words,
                 std::uint32_t* cells, std::uint32_t* fixed, std::uint32_t* irregular) {
  const Bytes d;
  const auto count = static_cast<int>(hn::Lanes(d));
  const auto zero = hn::Zero(d);
  const auto fixed_key = hn::Set(d, fixed_value_key);
  std::fill_n(cells, words, 0U);
  std::fill_n(fixed, words, 0U);
  std::fill_n(irregular, words, 0U);
  for (int x = 0; x < 32 * words; x += count, keys += count) {
    const auto key = hn::LoadU(d, keys);
    const unsigned is_fixed = Bits(hn::Eq(key, fixed_key));
    const unsigned is_cell = Bits(hn::Ne(key, zero)) & ~is_fixed;
    if ((is_cell | is_fixed) == 0) continue;
    const auto left = hn::LoadU(d, keys - 1);
    const auto right = hn::LoadU(d, keys + 1);
    const auto above = hn::LoadU(d, keys - keys_per_row);
    const auto below = hn::LoadU(d, keys + keys_per_row);
    const auto same_x = hn::And(hn::Eq(key, left), hn::Eq(key, right));
    const auto same_y = hn::And(hn::Eq(key, above), hn::Eq(key, below));
    const unsigned regular = Bits(hn::And(same_x, same_y));
    unsigned beside_cell = 0;
    if ((is_fixed & ~regular) != 0) {
      const auto is_other_cell = [&](auto other) HWY_ATTR {
        return hn::And(hn::Ne(other, zero), hn::Ne(other, fixed_key));
      };
      beside_cell = is_fixed & Bits(hn::Or(hn::Or(is_other_cell(left), is_other_cell(right)),
                                           hn::Or(is_other_cell(above), is_other_cell(below))));
    }
    const int shift = x % 32;
    cells[x / 32] |= is_cell << shift;
    fixed[x / 32] |= beside_cell << shift;
    irregular[x / 32] |= (is_cell & ~regular) << shift;
  }
}

/// Every second bit, beginning with the lowest, moved together.
HWY_INLINE unsigned EvenBits(std::uint32_t bits) {
  bits &= 0x55555555U;
  bits = (bits | (bits >> 1)) & 0x33333333U;
  bits = (bits | (bits >> 2)) & 0x0F0F0F0FU;
  bits = (bits | (bits >> 4)) & 0x00FF00FFU;
  return (bits | (bits >> 8)) & 0xFFFFU;
}

/// `value` where the bit is set, else 0; even and odd cells apart.
HWY_INLINE void StoreBits(std::uint32_t bits, float value, float* even, std::ptrdiff_t pitch) {
  for (int parity = 0; parity < 2; ++parity) {
    const unsigned half = EvenBits(bits >> parity);
    for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
      Store(hn::IfThenElseZero(LoadBits(half, i), Set(value)), even + parity * pitch + i);
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

void SetWeights(const std::uint32_t* cells, const std::uint32_t* fixed,
                std::ptrdiff_t words_per_row, Rows rows, MembraneLevel& level) {
  const std::ptrdiff_t pitch = level.pitch;
  for (int y = rows.first; y < rows.last; ++y) {
    ForEachBlock(level.stored, level.stored_rows, y, [&](int column) {
      const std::ptrdiff_t at = level.at(y, 0, column);
      if (level.block(y, column) == Block::empty) return;
      if (level.block(y, column) == Block::plain) {
        Fill(1.F, level.right.data() + at, pitch);
        Fill(1.F, level.down.data() + at, pitch);
        return;
      }
      const std::ptrdiff_t word = (y + 1) * words_per_row + column + 1;
      const std::uint32_t cell = cells[word];
      const std::uint32_t member = cell | fixed[word];
      const std::uint32_t next_cell = cells[word + 1];
      const std::uint32_t next_member = next_cell | fixed[word + 1];
      const std::uint32_t right_cell = (cell >> 1) | (next_cell << 31);
      const std::uint32_t right_member = (member >> 1) | (next_member << 31);
      const std::uint32_t lower_cell = cells[word + words_per_row];
      const std::uint32_t lower_member = lower_cell | fixed[word + words_per_row];
      const std::uint32_t to_right = member & right_member & (cell | right_cell);
      const std::uint32_t down = member & lower_member & (cell | lower_cell);
      StoreBits(to_right, 1.F, level.right.data() + at, pitch);
      StoreBits(down, 1.F, level.down.data() + at, pitch);
      StoreBits(fixed[word], -1.F, level.inverse.data() + at, pitch);
      const std::uint32_t left_cell = (cell << 1) | (cells[word - 1] >> 31);
      const std::uint32_t left_member = (member << 1) | ((cells[word - 1] | fixed[word - 1]) >> 31);
      const std::uint32_t upper_cell = cells[word - words_per_row];
      const std::uint32_t upper_member = upper_cell | fixed[word - words_per_row];
      const std::uint32_t directions[] = {member & left_member & (cell | left_cell), to_right,
                                          member & upper_member & (cell | upper_cell), down};
      for (int parity = 0; parity < 2; ++parity) {
        std::uint16_t* edges = level.edges_at(y, parity, column);
        for (int k = 0; k < 4; ++k) {
          edges[k] = static_cast<std::uint16_t>(EvenBits(directions[k] >> parity));
        }
      }
    });
  }
}

HWY_INLINE Mask IsFixed(Vector inverse) {
  return hn::Lt(inverse, Zero());
}
/// The cells of 2x2: of a fine row and the next, in the even and the odd column.
struct Four {
  Vector a, b, c, d;

  HWY_INLINE Four(const float* upper, std::ptrdiff_t pitch, std::ptrdiff_t row_step)
      : a(Load(upper)),
        b(Load(upper + pitch)),
        c(Load(upper + row_step)),
        d(Load(upper + row_step + pitch)) {}
  HWY_INLINE Vector Sum() const { return hn::Add(hn::Add(a, b), hn::Add(c, d)); }
  HWY_INLINE Vector Least() const { return hn::Min(hn::Min(a, b), hn::Min(c, d)); }
  HWY_INLINE Mask AnyFixed() const {
    return hn::Or(hn::Or(IsFixed(a), IsFixed(b)), hn::Or(IsFixed(c), IsFixed(d)));
  }
};

/// The conductance of one row of fine cells from a coarse cell's centre to the fixed value in the
/// coarse cell beside it. The value lies 1 / across beyond the near cell's last fine cell, or
/// 1 / inside beyond the other's first fine cell, or further away than that.
/// across: the fine edge between the two coarse cells; inside: the one in the far coarse cell.
HWY_INLINE Vector ConductanceToFixed(Vector across, Vector inside, Vector far_first,
                                     Vector far_second) {
  const Vector to_first = hn::Div(across, hn::MulAdd(Set(0.5F), across, Set(1.F)));
  const Vector to_second = hn::Div(inside, hn::MulAdd(Set(1.5F), inside, Set(1.F)));
  const Vector further = hn::IfThenElse(IsFixed(far_second), to_second, Set(0.4F));
  return hn::IfThenElseZero(hn::Gt(across, Zero()),
                            hn::IfThenElse(IsFixed(far_first), to_first, further));
}

/// Two rows (or columns) of fine cells from a coarse cell to the one beside it.
struct EdgeRow {
  Vector near_first, near_second, far_first, far_second;  ///< inverse diagonals
  Vector inside, across, beyond;                          ///< the edges between these four
};
/// The edges from one row to the other, between the cells that touch the other coarse cell.
struct Links {
  Vector near, far;
};

/// a and b one after the other.
HWY_INLINE Vector InSeries(Vector a, Vector b) {
  return hn::Div(hn::Mul(a, b), hn::Max(hn::Add(a, b), Set(1e-12F)));
}

/// From a coarse cell's centre to the fine cell that an edge across starts from: half a fine edge
/// inside its row, and what the other row has to spare by way of the link.
/// outer: the inverse diagonal of the row's other cell; without one the centre is no nearer.
HWY_INLINE Vector ConductanceFromCenter(Vector outer, Vector inside, Vector other_outer,
                                        Vector other_inside, Vector link, Vector spare) {
  const auto half_edge = [](Vector cell, Vector edge) HWY_ATTR {
    // A coarse cell that has a gap inside must not come loose: a correction that is too large
    // does harm, one that is too small is made up for in the next cycle.
    const Vector least = hn::Max(edge, Set(0.25F));
    return hn::Mul(Set(2.F), hn::IfThenElse(hn::Eq(cell, Zero()), Set(1.F), least));
  };
  return hn::MulAdd(spare, InSeries(half_edge(other_outer, other_inside), link),
                    half_edge(outer, inside));
}

/// Between the centres of two coarse cells: what crosses in the first row. Where only one row
/// crosses, however often that happens from level to level, resistances so add up as those of a
/// narrow gap do, and parts that hang together by a few pixels are neither torn nor glued.
HWY_INLINE Vector RowConductance(const EdgeRow& row, const EdgeRow& other, const Links& links) {
  const Vector spare =
      hn::Div(hn::Max(hn::Sub(row.across, other.across), Zero()), hn::Max(row.across, Set(1e-12F)));
  const Vector near = ConductanceFromCenter(row.near_first, row.inside, other.near_first,
                                            other.inside, links.near, spare);
  const Vector far = ConductanceFromCenter(row.far_second, row.beyond, other.far_second,
                                           other.beyond, links.far, spare);
  return InSeries(row.across, InSeries(near, far));
}

HWY_INLINE Vector CoarseWeight(const EdgeRow& p, const EdgeRow& q, const Links& links,
                               Mask near_fixed, Mask far_fixed) {
  const Floats d;
  const Vector plain = hn::Add(RowConductance(p, q, links), RowConductance(q, p, links));
  const Mask any_fixed = hn::Or(near_fixed, far_fixed);
  if (hn::AllFalse(d, any_fixed)) return plain;
  const Vector to_far = hn::Add(ConductanceToFixed(p.across, p.beyond, p.far_first, p.far_second),
                                ConductanceToFixed(q.across, q.beyond, q.far_first, q.far_second));
  const Vector to_near =
      hn::Add(ConductanceToFixed(p.across, p.inside, p.near_second, p.near_first),
              ConductanceToFixed(q.across, q.inside, q.near_second, q.near_first));
  const Vector one_fixed =
      hn::IfThenElse(far_fixed, hn::IfThenZeroElse(near_fixed, to_far), to_near);
  return hn::IfThenElse(any_fixed, one_fixed, plain);
}

/// What becomes of a block's worth of coarse cells, not yet sorted by parity.
struct CoarseCells {
  HWY_ALIGN float right[2 * lanes], down[2 * lanes], inverse[2 * lanes];
  HWY_ALIGN float right_side[channels][2 * lanes], x[channels][2 * lanes];
};

/// Where any of four cells is fixed, the coarse one is (McAdams, Sifakis & Teran 2010); how far
/// away the value really was is kept in the weights.
HWY_INLINE void CoarsenHalf(const MembraneLevel& fine, int y, int column, int offset,
                            CoarseCells& cells) {
  const std::ptrdiff_t pitch = fine.pitch;
  const std::ptrdiff_t row = fine.row_step();
  for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
    const std::ptrdiff_t at = fine.at(y, 0, column) + i;
    const std::ptrdiff_t to = offset + i;
    const float* inverse = fine.inverse.data() + at;
    const float* right = fine.right.data() + at;
    const float* down = fine.down.data() + at;
    const Four own(inverse, pitch, row);
    const Four beside(inverse + 1, pitch, row);
    const Four below(inverse + 2 * row, pitch, row);
    const Mask fixed = own.AnyFixed();
    const Mask beside_fixed = beside.AnyFixed();
    const Mask below_fixed = below.AnyFixed();
    const Four horizontal(right, pitch, row);
    const Four vertical(down, pitch, row);
    const Vector beyond_right[] = {Load(right + 1), Load(right + row + 1), Load(down + 1)};
    const Vector beyond_down[] = {Load(down + 2 * row), Load(down + 2 * row + pitch),
                                  Load(right + 2 * row)};
    Vector least = hn::Min(horizontal.Least(), vertical.Least());
    for (const Vector& edge : beyond_right) least = hn::Min(least, edge);
    for (const Vector& edge : beyond_down) least = hn::Min(least, edge);
    const Mask any_fixed = hn::Or(fixed, hn::Or(beside_fixed, below_fixed));
    const Mask plain = hn::AndNot(any_fixed, hn::Ge(least, Set(1.F)));
    if (hn::AllTrue(Floats(), plain)) {
      Store(Set(1.F), cells.right + to);
      Store(Set(1.F), cells.down + to);
    } else {
      Store(CoarseWeight(
                {own.a, own.b, beside.a, beside.b, horizontal.a, horizontal.b, beyond_right[0]},
                {own.c, own.d, beside.c, beside.d, horizontal.c, horizontal.d, beyond_right[1]},
                {vertical.b, beyond_right[2]}, fixed, beside_fixed),
            cells.right + to);
      Store(CoarseWeight({own.a, own.c, below.a, below.c, vertical.a, vertical.c, beyond_down[0]},
                         {own.b, own.d, below.b, below.d, vertical.b, vertical.d, beyond_down[1]},
                         {horizontal.c, beyond_down[2]}, fixed, below_fixed),
            cells.down + to);
    }
    Store(hn::IfThenElseZero(fixed, Set(-1.F)), cells.inverse + to);
    if (fine.has_sources) {
      for (int c = 0; c < channels; ++c) {
        const std::ptrdiff_t from = fine.at(y, c, 0, column) + i;
        Store(Four(fine.right_side.data() + from, pitch, fine.channel_row_step()).Sum(),
              cells.right_side[c] + to);
      }
    }
    if (hn::AllFalse(Floats(), fixed)) {
      for (int c = 0; c < channels; ++c) Store(Zero(), cells.x[c] + to);
      continue;
    }
    const auto one_if = [](Mask mask) HWY_ATTR { return hn::IfThenElseZero(mask, Set(1.F)); };
    const Vector count =
        hn::Max(Set(1.F), hn::Add(hn::Add(one_if(IsFixed(own.a)), one_if(IsFixed(own.b))),
                                  hn::Add(one_if(IsFixed(own.c)), one_if(IsFixed(own.d)))));
    for (int c = 0; c < channels; ++c) {
      Four x(fine.x.data() + fine.at(y, c, 0, column) + i, pitch, fine.channel_row_step());
      x.a = hn::IfThenElseZero(IsFixed(own.a), x.a);
      x.b = hn::IfThenElseZero(IsFixed(own.b), x.b);
      x.c = hn::IfThenElseZero(IsFixed(own.c), x.c);
      x.d = hn::IfThenElseZero(IsFixed(own.d), x.d);
      Store(hn::Div(x.Sum(), count), cells.x[c] + to);
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

void Coarsen(const MembraneLevel& fine, Rows rows, MembraneLevel& coarse) {
  const std::ptrdiff_t pitch = coarse.pitch;
  CoarseCells cells;
  for (int y = rows.first; y < rows.last; ++y) {
    ForEachBlock(coarse.stored, coarse.stored_rows, y, [&](int column) {
      const std::ptrdiff_t at = coarse.at(y, 0, column);
      const Block kind = coarse.block(y, column);
      if (kind == Block::empty) return;
      if (kind == Block::plain) {
        Fill(1.F, coarse.right.data() + at, pitch);
        Fill(1.F, coarse.down.data() + at, pitch);
        return;
      }
      for (int half = 0; half < 2; ++half) {
        const int fine_column = 2 * column + half;
        const Tile state = StateOf(fine, 2 * y, fine_column);
        if (state == Tile::active || state == Tile::ghost) {
          CoarsenHalf(fine, 2 * y, fine_column, half * lanes, cells);
          continue;
        }
        // Inside a smooth tile every weight is 1, as on the finer level.
        const float weight = state == Tile::smooth ? 1.F : 0.F;
        const int offset = half * lanes;
        std::fill_n(cells.right + offset, lanes, weight);
        std::fill_n(cells.down + offset, lanes, weight);
        std::fill_n(cells.inverse + offset, lanes, 0.F);
        for (int c = 0; c < channels; ++c) {
          std::fill_n(cells.right_side[c] + offset, lanes, 0.F);
          std::fill_n(cells.x[c] + offset, lanes, 0.F);
        }
      }
      StoreApart(cells.right, coarse.right.data() + at, pitch);
      StoreApart(cells.down, coarse.down.data() + at, pitch);
      StoreApart(cells.inverse, coarse.inverse.data() + at, pitch);
      for (int c = 0; c < channels; ++c) {
        const std::ptrdiff_t to = coarse.at(y, c, 0, column);
        if (fine.has_sources) {
          StoreApart(cells.right_side[c], coarse.right_side.data() + to, pitch);
        }
        StoreApart(cells.x[c], coarse.x.data() + to, pitch);
      }
    });
  }
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

void InvertDiagonal(Rows rows, MembraneLevel& level) {
  for (int y = rows.first; y < rows.last; ++y) {
    ForEachBlock(level.stored, level.stored_rows, y, [&](int column) {
      if (level.block(y, column) == Block::empty) return;
      if (level.block(y, column) == Block::plain) {
        Fill(0.25F, level.inverse.data() + level.at(y, 0, column), level.pitch);
        return;
      }
      for (int parity = 0; parity < 2; ++parity) {
        for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
          const std::ptrdiff_t at = level.at(y, parity, column) + i;
          const Vector sum = Weights(level, y, parity, column, i).Total();
          const Vector old = Load(level.inverse.data() + at);
          const Vector reciprocal = hn::IfThenElseZero(hn::Gt(sum, Zero()), hn::Div(Set(1.F), sum));
          Store(hn::IfThenElse(IsFixed(old), old, reciprocal), level.inverse.data() + at);
        }
      }
    });
  }
}

/// What is known of a sweep: it begins with values, as for x, whose plain blocks have no right
/// side; or it goes on with an error; or the error is zero yet.
enum class Start { x, error, zero };

/// Relaxes the cells of one parity of a row. first: nothing has been relaxed yet, so that with
/// Start::zero all neighbours are 0.
template <Start start, bool first>
HWY_INLINE void RelaxParity(const MembraneLevel& level, const float* HWY_RESTRICT right_side,
                            float* HWY_RESTRICT values, int y, int parity) {
  ForEachBlock(level.active, level.active_rows, y, [&](int column) {
    const Block kind = level.block(y, column);
    if (kind == Block::empty) return;
    for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
      const std::ptrdiff_t planes = level.at(y, 0, parity, column) + i;
      if (kind == Block::plain) {
        for (int c = 0; c < channels; ++c) {
          const std::ptrdiff_t at = planes + c * level.channel_step();
          Vector sum = start == Start::x ? Zero() : Load(right_side + at);
          if (!(start == Start::zero && first)) {
            sum = hn::Add(sum, Neighbours(level, values, at, parity).Total());
          }
          Store(hn::Mul(sum, Set(0.25F)), values + at);
        }
        continue;
      }
      const Vector inverse = Load(level.inverse.data() + level.at(y, parity, column) + i);
      const Mask cell = hn::Gt(inverse, Zero());
      if (hn::AllFalse(Floats(), cell)) {
        if (start != Start::zero) continue;
        for (int c = 0; c < channels; ++c)
          Store(Zero(), values + planes + c * level.channel_step());
        continue;
      }
      if (start == Start::x && !level.edges.empty()) {
        const EdgeMasks edges(level.edges_at(y, parity, column), i);
        for (int c = 0; c < channels; ++c) {
          const std::ptrdiff_t at = planes + c * level.channel_step();
          Vector sum = edges.Sum(Neighbours(level, values, at, parity));
          if (level.has_sources) sum = hn::Add(sum, Load(right_side + at));
          Store(hn::IfThenElse(cell, hn::Mul(sum, inverse), Load(values + at)), values + at);
        }
        continue;
      }
      const Weights weights(level, y, parity, column, i);
      for (int c = 0; c < channels; ++c) {
        const std::ptrdiff_t at = planes + c * level.channel_step();
        Vector sum = Load(right_side + at);
        if (!(start == Start::zero && first)) {
          sum = Neighbours(level, values, at, parity).Weighted(weights, sum);
        }
        const Vector relaxed = hn::Mul(sum, inverse);
        if (start == Start::zero) {
          Store(hn::IfThenElseZero(cell, relaxed), values + at);
        } else {
          Store(hn::IfThenElse(cell, relaxed, Load(values + at)), values + at);
        }
      }
    }
  });
}

/// Black cells of a row: those that are relaxed second.
template <Start start>
HWY_INLINE void RelaxBlack(const MembraneLevel& level, const float* right_side, float* values,
                           int y) {
  RelaxParity<start, false>(level, right_side, values, y, (y + 1) & 1);
}

template <Start start>
HWY_INLINE void RelaxRows(const MembraneLevel& level, const float* right_side, float* values,
                          Rows rows) {
  // The red cells of a row, then the black ones of the row above, whose neighbours are then all
  // new: one pass over memory.
  for (int y = rows.first; y < rows.last; ++y) {
    RelaxParity<start, true>(level, right_side, values, y, y & 1);
    const bool above_is_seam = y - 1 == rows.first && rows.first > 0;
    if (y > rows.first && !above_is_seam) RelaxBlack<start>(level, right_side, values, y - 1);
  }
  if (rows.last == level.height) RelaxBlack<start>(level, right_side, values, rows.last - 1);
}

void Relax(const MembraneLevel& level, const float* right_side, float* values, bool from_zero,
           Rows rows) {
  if (!from_zero) {
    return values == level.x.data() ? RelaxRows<Start::x>(level, right_side, values, rows)
                                    : RelaxRows<Start::error>(level, right_side, values, rows);
  }
  if (level.has_smooth || level.height < 2) {
    const int end = rows.last == level.height ? level.rows() : rows.last;
    for (int y = rows.first; y < end; ++y) {
      ForEachBlock(level.stored, level.stored_rows, y, [&](int column) {
        for (int c = 0; c < channels; ++c) {
          Fill(0.F, values + level.at(y, c, 0, column), level.pitch);
        }
      });
    }
  }
  RelaxRows<Start::zero>(level, right_side, values, rows);
}

void RelaxSeam(const MembraneLevel& level, const float* right_side, float* values, bool from_zero,
               int row) {
  for (int y = row - 1; y <= row; ++y) {
    if (from_zero) {
      RelaxBlack<Start::zero>(level, right_side, values, y);
    } else if (values == level.x.data()) {
      RelaxBlack<Start::x>(level, right_side, values, y);
    } else {
      RelaxBlack<Start::error>(level, right_side, values, y);
    }
  }
}

/// A fixed cell stands for a value somewhere between its centre and the next cell's. Gives it the
/// value that continues the line through both.
HWY_INLINE Vector Continued(Vector weight, Vector neighbour, Vector fixed_value) {
  const Vector line =
      hn::MulAdd(hn::Sub(Set(1.F), weight), hn::Sub(neighbour, fixed_value), fixed_value);
  return hn::IfThenElseZero(hn::Gt(weight, Zero()), line);
}

void ExtendOverFixed(const MembraneLevel& level, float* values) {
  const auto present = [](Vector weight) {
    return hn::IfThenElseZero(hn::Gt(weight, Zero()), Set(1.F));
  };
  for (int y = 0; y < level.height; ++y) {
    ForEachBlock(level.active, level.active_rows, y, [&](int column) HWY_ATTR {
      if (level.block(y, column) != Block::general) return;
      for (int parity = 0; parity < 2; ++parity) {
        for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
          const Mask fixed = IsFixed(Load(level.inverse.data() + level.at(y, parity, column) + i));
          if (hn::AllFalse(Floats(), fixed)) continue;
          const Weights w(level, y, parity, column, i);
          const Vector count = hn::Add(hn::Add(present(w.left), present(w.right)),
                                       hn::Add(present(w.up), present(w.down)));
          const Vector scale = hn::Div(Set(1.F), hn::Max(count, Set(1.F)));
          const Mask changed = hn::And(fixed, hn::Gt(count, Zero()));
          for (int c = 0; c < channels; ++c) {
            const std::ptrdiff_t at = level.at(y, c, parity, column) + i;
            const Neighbours n(level, values, at, parity);
            const Vector own = Load(values + at);
            const Vector sum =
                hn::Add(hn::Add(Continued(w.left, n.left, own), Continued(w.right, n.right, own)),
                        hn::Add(Continued(w.up, n.up, own), Continued(w.down, n.down, own)));
            Store(hn::IfThenElse(changed, hn::Mul(sum, scale), own), values + at);
          }
        }
      }
    });
  }
}

/// What fine cells inside fixed coarse cells have left over is passed on to the coarse cells beside
/// them, as much as these will change them.
void CollectFromFixed(MembraneLevel& level) {
  float* residual = level.residual.data();
  const auto share = [](Vector weight, Vector inverse) {
    const Mask from = hn::And(IsFixed(inverse), hn::Gt(weight, Zero()));
    return hn::IfThenElseZero(from, hn::Max(hn::NegMulAdd(Set(0.75F), weight, Set(1.F)), Zero()));
  };
  for (int y = 0; y < level.height; ++y) {
    ForEachBlock(level.active, level.active_rows, y, [&](int column) HWY_ATTR {
      if (level.block(y, column) != Block::general) return;
      for (int parity = 0; parity < 2; ++parity) {
        for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
          const std::ptrdiff_t at = level.at(y, parity, column) + i;
          const float* inverse = level.inverse.data();
          const float* beside = inverse + level.at(y, 1 - parity, column) + i;
          const Weights w(level, y, parity, column, i);
          const Vector left = share(w.left, Load(beside - 1 + parity));
          const Vector right = share(w.right, Load(beside + parity));
          const Vector up = share(w.up, Load(inverse + at - level.row_step()));
          const Vector down = share(w.down, Load(inverse + at + level.row_step()));
          const Mask cell = hn::Gt(Load(inverse + at), Zero());
          const Mask any =
              hn::And(cell, hn::Gt(hn::Add(hn::Add(left, right), hn::Add(up, down)), Zero()));
          if (hn::AllFalse(Floats(), any)) continue;
          for (int c = 0; c < channels; ++c) {
            const std::ptrdiff_t own = level.at(y, c, parity, column) + i;
            const Neighbours n(level, residual, own, parity);
            const Vector old = Load(residual + own);
            const Vector more =
                hn::MulAdd(left, n.left,
                           hn::MulAdd(right, n.right, hn::MulAdd(up, n.up, hn::Mul(down, n.down))));
            Store(hn::IfThenElse(any, hn::Add(old, more), old), residual + own);
          }
        }
      }
    });
  }
}

/// What is left of the equations of one parity of a row.
HWY_INLINE void Residual(const MembraneLevel& level, const float* right_side, const float* values,
                         int y, int parity, int column, std::ptrdiff_t i, Vector* result) {
  const std::ptrdiff_t single = level.at(y, parity, column) + i;
  const std::ptrdiff_t planes = level.at(y, 0, parity, column) + i;
  if (level.block(y, column) == Block::plain) {
    for (int c = 0; c < channels; ++c) {
      const std::ptrdiff_t at = planes + c * level.channel_step();
      Vector sum = Neighbours(level, values, at, parity).Total();
      // In plain blocks of the finest level there are no sources.
      if (level.edges.empty()) sum = hn::Add(sum, Load(right_side + at));
      result[c] = hn::NegMulAdd(Set(4.F), Load(values + at), sum);
    }
    return;
  }
  const Mask cell = hn::Gt(Load(level.inverse.data() + single), Zero());
  if (hn::AllFalse(Floats(), cell)) return;  // `result` is 0 already
  if (!level.edges.empty()) {
    const EdgeMasks edges(level.edges_at(y, parity, column), i);
    const Vector count = edges.Count();
    for (int c = 0; c < channels; ++c) {
      const std::ptrdiff_t at = planes + c * level.channel_step();
      Vector sum = edges.Sum(Neighbours(level, values, at, parity));
      if (level.has_sources) sum = hn::Add(sum, Load(right_side + at));
      result[c] = hn::IfThenElseZero(cell, hn::NegMulAdd(count, Load(values + at), sum));
    }
    return;
  }
  const Weights weights(level, y, parity, column, i);
  const Vector diagonal = weights.Total();
  for (int c = 0; c < channels; ++c) {
    const std::ptrdiff_t at = planes + c * level.channel_step();
    const Vector sum =
        Neighbours(level, values, at, parity).Weighted(weights, Load(right_side + at));
    result[c] = hn::IfThenElseZero(cell, hn::NegMulAdd(diagonal, Load(values + at), sum));
  }
}

/// The equations of a coarser level's own cells, which lie in a tile that the finer one leaves out:
/// half a block.
HWY_INLINE void OwnResidual(MembraneLevel& level, int y, int column, int half) {
  const hn::CappedTag<float, lanes / 2> d;
  const std::ptrdiff_t row_step = level.channel_row_step();
  for (int c = 0; c < channels; ++c) {
    for (int parity = 0; parity < 2; ++parity) {
      const std::ptrdiff_t block = level.at(y, c, parity, column) + half * (lanes / 2);
      for (std::ptrdiff_t i = 0; i < lanes / 2; i += static_cast<std::ptrdiff_t>(hn::Lanes(d))) {
        const float* x = level.x.data() + block + i;
        const float* beside = x + (parity == 0 ? level.pitch : -level.pitch);
        const auto sum =
            hn::Add(hn::Add(hn::LoadU(d, beside - 1 + parity), hn::LoadU(d, beside + parity)),
                    hn::Add(hn::LoadU(d, x - row_step), hn::LoadU(d, x + row_step)));
        hn::StoreU(hn::NegMulAdd(hn::Set(d, 4.F), hn::LoadU(d, x), sum), d,
                   level.residual.data() + block + i);
      }
    }
  }
}

/// Where a tile of the fine level that is active touches one that is left to the coarse level: the
/// flux between them, as the fine level sees it, replaces the one the coarse level sees.
class FluxCorrection {
 public:
  FluxCorrection(const MembraneLevel& fine, const float* values, MembraneLevel& coarse)
      : fine_(fine), values_(values == fine.x.data() ? nullptr : values), coarse_(coarse) {}

  void Apply() {
    for (int row = 0; row < fine_.tile_rows; ++row) {
      for (int column = 0; column < fine_.tile_columns; ++column) {
        if (fine_.state(column, row) != Tile::ghost) continue;
        for (const auto& [dx, dy] : neighbour_offsets) {
          if (fine_.state(column + dx, row + dy) == Tile::active) Side(column, row, dx, dy);
        }
      }
    }
  }

 private:
  static std::ptrdiff_t Index(const MembraneLevel& level, int x, int y, int c) {
    // x may be -1 or one beyond the last tile: the margin's.
    const int column = (x + MembraneLevel::tile_width) / MembraneLevel::tile_width - 1;
    const int within = x - column * MembraneLevel::tile_width;
    return level.at(y, c, within % 2, column) + within / 2;
  }
  float Fine(int x, int y, int c) const {
    const std::ptrdiff_t at = Index(fine_, x, y, c);
    return fine_.x.data()[at] + (values_ ? values_[at] : 0.F);
  }
  float Coarse(int x, int y, int c) const { return coarse_.x.data()[Index(coarse_, x, y, c)]; }

  void Side(int column, int row, int dx, int dy) {
    constexpr int width = MembraneLevel::tile_width / 2;
    constexpr int height = tile_height / 2;
    const int count = dx == 0 ? width : height;
    for (int i = 0; i < count; ++i) {
      const int x = column * width + (dx == 0 ? i : dx < 0 ? 0 : width - 1);
      const int y = row * height + (dy == 0 ? i : dy < 0 ? 0 : height - 1);
      // The two fine cells of the coarse one that lie on this side.
      const int fine_x = 2 * x + (dx > 0 ? 1 : 0);
      const int fine_y = 2 * y + (dy > 0 ? 1 : 0);
      for (int c = 0; c < channels; ++c) {
        float flux = Coarse(x, y, c) - Coarse(x + dx, y + dy, c);
        for (int k = 0; k < 2; ++k) {
          const int px = fine_x + (dx == 0 ? k : 0);
          const int py = fine_y + (dy == 0 ? k : 0);
          flux -= Fine(px, py, c) - Fine(px + dx, py + dy, c);
        }
        coarse_.residual.data()[Index(coarse_, x, y, c)] += flux;
      }
    }
  }

  const MembraneLevel& fine_;
  const float* values_;
  MembraneLevel& coarse_;
};

double RestrictResidual(const MembraneLevel& fine, const float* right_side, const float* values,
                        Rows rows, MembraneLevel& coarse) {
  HWY_ALIGN float sums[channels][2 * lanes];
  Vector squares = Zero();
  for (int y = rows.first; y < rows.last; ++y) {
    ForEachBlock(coarse.active, coarse.active_rows, y, [&](int column) HWY_ATTR {
      if (coarse.block(y, column) == Block::empty) return;
      Tile states[2];
      for (int half = 0; half < 2; ++half) {
        const int fine_column = 2 * column + half;
        states[half] = StateOf(fine, 2 * y, fine_column);
        const bool active = states[half] == Tile::active;
        const bool upper = active && fine.block(2 * y, fine_column) != Block::empty;
        const bool lower = active && fine.block(2 * y + 1, fine_column) != Block::empty;
        for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
          // Black cells were relaxed last: nothing is left there. Red ones are in even columns of
          // even rows and odd columns of odd rows.
          Vector even[channels] = {Zero(), Zero(), Zero()};
          Vector odd[channels] = {Zero(), Zero(), Zero()};
          if (upper) Residual(fine, right_side, values, 2 * y, 0, fine_column, i, even);
          if (lower) Residual(fine, right_side, values, 2 * y + 1, 1, fine_column, i, odd);
          for (int c = 0; c < channels; ++c) {
            const Vector sum = hn::Add(even[c], odd[c]);
            squares = hn::MulAdd(sum, sum, squares);
            Store(sum, sums[c] + half * lanes + i);
          }
        }
      }
      for (int c = 0; c < channels; ++c) {
        StoreApart(sums[c], coarse.residual.data() + coarse.at(y, c, 0, column), coarse.pitch);
      }
      for (int half = 0; half < 2; ++half) {
        if (states[half] == Tile::smooth || states[half] == Tile::ghost) {
          OwnResidual(coarse, y, column, half);
        }
      }
    });
  }
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(Floats(), squares)));
}

void FinishResidual(const MembraneLevel& fine, const float* values, MembraneLevel& coarse) {
  if (fine.has_smooth) FluxCorrection(fine, values, coarse).Apply();
  CollectFromFixed(coarse);
}

/// Coarse values around one fine row, blended vertically, in the order of the columns.
struct BlendedRow {
  // A cell before and one after the block's own; 16 for alignment.
  HWY_ALIGN float values[channels][4 * lanes];
  HWY_ALIGN float presence[4 * lanes];

  /// Of cells that all exist.
  HWY_INLINE void SetPlain(const MembraneLevel& coarse, const float* coarse_values, int y,
                           int fine_column) {
    const int near_y = y / 2;
    const int far_y = y % 2 == 0 ? near_y - 1 : near_y + 1;
    const std::ptrdiff_t offset = fine_column % 2 * (lanes / 2) - 1;
    for (std::ptrdiff_t i = 0; i < lanes / 2 + 2; i += VectorSize()) {
      for (int c = 0; c < channels; ++c) {
        Vector blended[2];
        for (int parity = 0; parity < 2; ++parity) {
          const Vector near =
              Load(coarse_values + coarse.at(near_y, c, parity, fine_column / 2) + offset + i);
          const Vector far =
              Load(coarse_values + coarse.at(far_y, c, parity, fine_column / 2) + offset + i);
          blended[parity] =
              hn::MulAdd(hn::Set(Floats(), 0.75F), near, hn::Mul(hn::Set(Floats(), 0.25F), far));
        }
        hn::StoreInterleaved2(blended[0], blended[1], Floats(), values[c] + 2 * i);
      }
    }
  }

  /// Of cells some of which may not exist; sets `presence`, too.
  HWY_INLINE void Set(const MembraneLevel& coarse, const float* coarse_values, int y,
                      int fine_column) {
    const int near_y = y / 2;
    const int far_y = y % 2 == 0 ? near_y - 1 : near_y + 1;
    const int column = fine_column / 2;
    // The 16 coarse cells wanted are 8 of each parity, from `offset`; one more on both sides.
    const std::ptrdiff_t offset = fine_column % 2 * (lanes / 2) - 1;
    const hn::CappedTag<float, lanes> d;
    for (std::ptrdiff_t i = 0; i < lanes / 2 + 2; i += VectorSize()) {
      Vector near_weight[2], far_weight[2];
      for (int parity = 0; parity < 2; ++parity) {
        near_weight[parity] = hn::IfThenElseZero(
            hn::Ne(Load(coarse.inverse.data() + coarse.at(near_y, parity, column) + offset + i),
                   Zero()),
            hn::Set(d, 0.75F));
        far_weight[parity] = hn::IfThenElseZero(
            hn::Ne(Load(coarse.inverse.data() + coarse.at(far_y, parity, column) + offset + i),
                   Zero()),
            hn::Set(d, 0.25F));
      }
      hn::StoreInterleaved2(hn::Add(near_weight[0], far_weight[0]),
                            hn::Add(near_weight[1], far_weight[1]), d, presence + 2 * i);
      for (int c = 0; c < channels; ++c) {
        Vector blended[2];
        for (int parity = 0; parity < 2; ++parity) {
          const Vector near =
              Load(coarse_values + coarse.at(near_y, c, parity, column) + offset + i);
          const Vector far = Load(coarse_values + coarse.at(far_y, c, parity, column) + offset + i);
          blended[parity] = hn::MulAdd(near_weight[parity], near, hn::Mul(far_weight[parity], far));
        }
        hn::StoreInterleaved2(blended[0], blended[1], d, values[c] + 2 * i);
      }
    }
  }
};

/// Three quarters of the coarse cell that a fine one lies in and one of the cell beside it.
HWY_INLINE Vector BlendColumns(const float* row, std::ptrdiff_t i, int parity) {
  // Two cells of `row` precede the block's own.
  const Vector own = Load(row + 2 + i);
  const Vector beside = Load(row + 2 + i + (parity == 0 ? -1 : 1));
  return hn::MulAdd(Set(0.75F), own, hn::Mul(Set(0.25F), beside));
}

template <bool add>
HWY_INLINE double ProlongRows(const MembraneLevel& coarse, const float* coarse_values, Rows rows,
                              const MembraneLevel& fine, float* values) {
  // Two, in turn, so that none is read just after it was written.
  BlendedRow blended[2];
  int turn = 0;
  Vector squares = Zero();
  const auto finish = [&](const BlendedRow& row, int y, int column) HWY_ATTR {
    const bool plain = fine.block(y, column) == Block::plain;
    for (int parity = 0; parity < 2; ++parity) {
      for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
        const Vector inverse = Load(fine.inverse.data() + fine.at(y, parity, column) + i);
        const Mask cell = hn::Gt(inverse, Zero());
        if (hn::AllFalse(Floats(), cell)) continue;
        Vector scale = Set(1.F);
        if (!plain) {
          scale = hn::Div(scale, hn::Max(BlendColumns(row.presence, i, parity), Set(1e-6F)));
        }
        for (int c = 0; c < channels; ++c) {
          float* target = values + fine.at(y, c, parity, column) + i;
          const Vector old = Load(target);
          const Vector step =
              hn::IfThenElseZero(cell, hn::Mul(BlendColumns(row.values[c], i, parity), scale));
          Store(add ? hn::Add(old, step) : hn::IfThenElse(cell, step, old), target);
          if (add) squares = hn::MulAdd(step, step, squares);
        }
      }
    }
  };
  for (int y = rows.first; y < rows.last; ++y) {
    int pending = -1;
    ForEachBlock(fine.stored, fine.stored_rows, y, [&](int column) HWY_ATTR {
      const Block kind = fine.block(y, column);
      if (kind == Block::empty) return;
      // Where there is no cell, an error is 0.
      if (add && kind == Block::plain) {
        blended[turn].SetPlain(coarse, coarse_values, y, column);
      } else {
        blended[turn].Set(coarse, coarse_values, y, column);
      }
      if (pending >= 0) finish(blended[1 - turn], y, pending);
      turn = 1 - turn;
      pending = column;
    });
    if (pending >= 0) finish(blended[1 - turn], y, pending);
  }
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(Floats(), squares)));
}

double Prolong(const MembraneLevel& coarse, const float* coarse_values, bool add, Rows rows,
               const MembraneLevel& fine, float* values) {
  return add ? ProlongRows<true>(coarse, coarse_values, rows, fine, values)
             : ProlongRows<false>(coarse, coarse_values, rows, fine, values);
}

void AddError(MembraneLevel& level) {
  for (int y = 0; y < level.rows(); ++y) {
    ForEachBlock(level.stored, level.stored_rows, y, [&](int column) {
      if (level.block(y, column) == Block::empty) return;
      for (int c = 0; c < channels; ++c) {
        for (int parity = 0; parity < 2; ++parity) {
          const std::ptrdiff_t at = level.at(y, c, parity, column);
          for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
            float* x = level.x.data() + at + i;
            Store(hn::Add(Load(x), Load(level.error.data() + at + i)), x);
          }
        }
      }
    });
  }
}

void FillSmooth(MembraneLevel& level, const MembraneLevel& coarse) {
  BlendedRow row;
  for (int y = 0; y < level.height; ++y) {
    for (int column = 0; column < level.tile_columns; ++column) {
      if (level.state(column, y / tile_height) != Tile::smooth) continue;
      row.SetPlain(coarse, coarse.x.data(), y, column);
      for (int c = 0; c < channels; ++c) {
        for (int parity = 0; parity < 2; ++parity) {
          float* x = level.x.data() + level.at(y, c, parity, column);
          for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
            Store(BlendColumns(row.values[c], i, parity), x + i);
          }
        }
      }
    }
  }
}

void ReadBlock(const MembraneLevel& level, const MembraneLevel& coarse, int y, int column,
               float* result) {
  const Tile state = level.state(column, y / tile_height);
  if (state == Tile::active) {
    for (int c = 0; c < channels; ++c) {
      const float* even = level.x.data() + level.at(y, c, 0, column);
      for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
        hn::StoreInterleaved2(Load(even + i), Load(even + level.pitch + i), Floats(),
                              result + c * 2 * lanes + 2 * i);
      }
    }
    return;
  }
  BlendedRow row;
  row.SetPlain(coarse, coarse.x.data(), y, column);
  for (int c = 0; c < channels; ++c) {
    for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
      hn::StoreInterleaved2(BlendColumns(row.values[c], i, 0), BlendColumns(row.values[c], i, 1),
                            Floats(), result + c * 2 * lanes + 2 * i);
    }
  }
}

}  // namespace
}  // namespace diminish::membrane::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish::membrane {

HWY_EXPORT(ClassifyRow);
HWY_EXPORT(SetWeights);
HWY_EXPORT(Coarsen);
HWY_EXPORT(InvertDiagonal);
HWY_EXPORT(Relax);
HWY_EXPORT(RelaxSeam);
HWY_EXPORT(RestrictResidual);
HWY_EXPORT(FinishResidual);
HWY_EXPORT(Prolong);
HWY_EXPORT(AddError);
HWY_EXPORT(ExtendOverFixed);
HWY_EXPORT(FillSmooth);
HWY_EXPORT(ReadBlock);

void classify_row(const std::uint8_t* keys, std::ptrdiff_t keys_per_row, int words,
                  std::uint32_t* cells, std::uint32_t* fixed, std::uint32_t* irregular) {
  HWY_DYNAMIC_DISPATCH(ClassifyRow)(keys, keys_per_row, words, cells, fixed, irregular);
}
void set_weights(const std::uint32_t* cells, const std::uint32_t* fixed,
                 std::ptrdiff_t words_per_row, Rows rows, MembraneLevel& level) {
  HWY_DYNAMIC_DISPATCH(SetWeights)(cells, fixed, words_per_row, rows, level);
}
void coarsen(const MembraneLevel& fine, Rows rows, MembraneLevel& coarse) {
  HWY_DYNAMIC_DISPATCH(Coarsen)(fine, rows, coarse);
}
void invert_diagonal(Rows rows, MembraneLevel& level) {
  HWY_DYNAMIC_DISPATCH(InvertDiagonal)(rows, level);
}
void relax(const MembraneLevel& level, const float* right_side, float* values, bool from_zero,
           Rows rows) {
  HWY_DYNAMIC_DISPATCH(Relax)(level, right_side, values, from_zero, rows);
}
void relax_seam(const MembraneLevel& level, const float* right_side, float* values, bool from_zero,
                int row) {
  HWY_DYNAMIC_DISPATCH(RelaxSeam)(level, right_side, values, from_zero, row);
}
double restrict_residual(const MembraneLevel& fine, const float* right_side, const float* values,
                         Rows rows, MembraneLevel& coarse) {
  return HWY_DYNAMIC_DISPATCH(RestrictResidual)(fine, right_side, values, rows, coarse);
}
void finish_residual(const MembraneLevel& fine, const float* values, MembraneLevel& coarse) {
  HWY_DYNAMIC_DISPATCH(FinishResidual)(fine, values, coarse);
}
void extend_over_fixed(const MembraneLevel& level, float* values) {
  HWY_DYNAMIC_DISPATCH(ExtendOverFixed)(level, values);
}
double prolong(const MembraneLevel& coarse, const float* coarse_values, bool add, Rows rows,
               const MembraneLevel& fine, float* values) {
  return HWY_DYNAMIC_DISPATCH(Prolong)(coarse, coarse_values, add, rows, fine, values);
}
void add_error(MembraneLevel& level) {
  HWY_DYNAMIC_DISPATCH(AddError)(level);
}
void fill_smooth(MembraneLevel& level, const MembraneLevel& coarse) {
  HWY_DYNAMIC_DISPATCH(FillSmooth)(level, coarse);
}
void read_block(const MembraneLevel& level, const MembraneLevel& coarse, int y, int column,
                float* result) {
  HWY_DYNAMIC_DISPATCH(ReadBlock)(level, coarse, y, column, result);
}

}  // namespace diminish::membrane
#endif
