#include "membrane/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "membrane/relaxation.cpp"
#include <hwy/foreach_target.h>
// Anew for each instruction set.
#include "membrane/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::membrane::HWY_NAMESPACE {
namespace {

/// How a sweep starts: with values, as for x, whose plain blocks have no right side; with an error;
/// or with a zero error.
enum class Start { x, error, zero };

/// The blocks [first, last) of a row, all plain. has_neighbours: the cells beside them are not all
/// zero.
template <Start start, bool has_neighbours>
HWY_INLINE void RelaxPlain(const MembraneLevel& level, const float* HWY_RESTRICT right_side,
                           float* HWY_RESTRICT values, int y, int parity, int first, int last) {
  const std::ptrdiff_t count = std::ptrdiff_t{lanes} * (last - first);
  for (int c = 0; c < channels; ++c) {
    const std::ptrdiff_t begin = level.at(y, c, parity, first);
    for (std::ptrdiff_t at = begin; at < begin + count; at += VectorSize()) {
      Vector sum = start == Start::x ? Zero() : Load(right_side + at);
      if (has_neighbours) {
        const Vector beside = Neighbours(level, values, at, parity).Total();
        sum = start == Start::x ? beside : hn::Add(sum, beside);
      }
      Store(hn::Mul(sum, Set(0.25F)), values + at);
    }
  }
}

template <Start start, bool has_neighbours>
HWY_INLINE void RelaxGeneral(const MembraneLevel& level, const float* HWY_RESTRICT right_side,
                             float* HWY_RESTRICT values, int y, int parity, int column) {
  for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
    const std::ptrdiff_t planes = level.at(y, 0, parity, column) + i;
    const Vector inverse = Load(level.inverse.data() + level.at(y, parity, column) + i);
    const Mask cell = hn::Gt(inverse, Zero());
    if (hn::AllFalse(Floats(), cell)) {
      if (start != Start::zero) continue;
      for (int c = 0; c < channels; ++c) Store(Zero(), values + planes + c * level.channel_step());
      continue;
    }
    const Weights weights(level, y, parity, column, i);
    for (int c = 0; c < channels; ++c) {
      const std::ptrdiff_t at = planes + c * level.channel_step();
      Vector sum = start == Start::x && !level.has_sources ? Zero() : Load(right_side + at);
      if (has_neighbours) sum = Neighbours(level, values, at, parity).Weighted(weights, sum);
      const Vector relaxed = hn::Mul(sum, inverse);
      if (start == Start::zero) {
        Store(hn::IfThenElseZero(cell, relaxed), values + at);
      } else {
        Store(hn::IfThenElse(cell, relaxed, Load(values + at)), values + at);
      }
    }
  }
}

/// Relaxes the cells of one parity of a row. first: nothing has been relaxed yet, so that with
/// Start::zero all neighbours are 0.
template <Start start, bool first>
HWY_INLINE void RelaxParity(const MembraneLevel& level, const float* HWY_RESTRICT right_side,
                            float* HWY_RESTRICT values, int y, int parity) {
  constexpr bool has_neighbours = !(start == Start::zero && first);
  ForEachRun(level, level.active, y, [&](Block kind, int begin, int end) HWY_ATTR {
    if (kind == Block::plain) {
      RelaxPlain<start, has_neighbours>(level, right_side, values, y, parity, begin, end);
      return;
    }
    for (int column = begin; column < end; ++column) {
      RelaxGeneral<start, has_neighbours>(level, right_side, values, y, parity, column);
    }
  });
}

/// Black cells of a row, which are relaxed second.
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
  const bool last_is_seam = rows.last - 1 == rows.first && rows.first > 0;
  if (rows.last == level.height && !last_is_seam) {
    RelaxBlack<start>(level, right_side, values, rows.last - 1);
  }
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
      ForEachBlock(level.stored, y, [&](int column) {
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

}  // namespace
}  // namespace diminish::membrane::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish::membrane {

HWY_EXPORT(Relax);
HWY_EXPORT(RelaxSeam);

void relax(const MembraneLevel& level, const float* right_side, float* values, bool from_zero,
           Rows rows) {
  HWY_DYNAMIC_DISPATCH(Relax)(level, right_side, values, from_zero, rows);
}
void relax_seam(const MembraneLevel& level, const float* right_side, float* values, bool from_zero,
                int row) {
  HWY_DYNAMIC_DISPATCH(RelaxSeam)(level, right_side, values, from_zero, row);
}

}  // namespace diminish::membrane
#endif
