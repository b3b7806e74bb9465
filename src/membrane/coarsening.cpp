#include "membrane/kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "membrane/coarsening.cpp"
#include <hwy/foreach_target.h>
// Anew for each instruction set.
#include "membrane/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::membrane::HWY_NAMESPACE {
namespace {

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
    // A coarse cell with a gap inside must not become detached. A correction that is too large does
    // harm; one that is too small is made up for in the next cycle.
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

/// Coarse cells of a block, not yet sorted by parity.
struct CoarseCells {
  HWY_ALIGN float right[2 * lanes], down[2 * lanes], inverse[2 * lanes];
  HWY_ALIGN float right_side[channels][2 * lanes], x[channels][2 * lanes];
};

/// A coarse cell is fixed if any of its four cells is (McAdams, Sifakis & Teran 2010). The weights
/// keep how far away the value really was.
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

void Coarsen(const MembraneLevel& fine, Rows rows, MembraneLevel& coarse) {
  const std::ptrdiff_t pitch = coarse.pitch;
  CoarseCells cells;
  for (int y = rows.first; y < rows.last; ++y) {
    ForEachBlock(coarse.stored, y, [&](int column) {
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
        if (state == Tile::active) {
          CoarsenHalf(fine, 2 * y, fine_column, half * lanes, cells);
          continue;
        }
        // Inside a smooth tile every weight is 1, as on the finer level.
        const float weight = state == Tile::empty ? 0.F : 1.F;
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

}  // namespace
}  // namespace diminish::membrane::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish::membrane {

HWY_EXPORT(Coarsen);

void coarsen(const MembraneLevel& fine, Rows rows, MembraneLevel& coarse) {
  HWY_DYNAMIC_DISPATCH(Coarsen)(fine, rows, coarse);
}

}  // namespace diminish::membrane
#endif
