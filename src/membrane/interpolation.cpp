#include "membrane/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "membrane/interpolation.cpp"
#include <hwy/foreach_target.h>
// Anew for each instruction set.
#include "membrane/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::membrane::HWY_NAMESPACE {
namespace {

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
    ForEachBlock(level.active, y, [&](int column) HWY_ATTR {
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

// As many coarse cells of one parity as half a block of fine ones lies in.
using Halves = hn::CappedTag<float, lanes / 2>;
using Half = hn::Vec<Halves>;

HWY_INLINE std::ptrdiff_t HalfSize() {
  return static_cast<std::ptrdiff_t>(hn::Lanes(Halves()));
}

/// Three quarters of one, one quarter of the other.
HWY_INLINE Half Mix(Half near, Half far) {
  return hn::MulAdd(hn::Set(Halves(), 0.75F), near, hn::Mul(hn::Set(Halves(), 0.25F), far));
}

/// Of a row of coarse cells: some even ones, the odd ones beside them, the odd ones before and the
/// even ones after these.
struct CoarseRow {
  Half even, odd, before, after;

  /// Of two rows, `far` further away.
  HWY_INLINE CoarseRow(const float* near, const float* far, std::ptrdiff_t pitch) {
    const auto mix = [&](std::ptrdiff_t i) HWY_ATTR {
      return Mix(hn::LoadU(Halves(), near + i), hn::LoadU(Halves(), far + i));
    };
    even = mix(0);
    odd = mix(pitch);
    before = mix(pitch - 1);
    after = mix(1);
  }
  HWY_INLINE CoarseRow(Half even_, Half odd_, Half before_, Half after_)
      : even(even_), odd(odd_), before(before_), after(after_) {}
};

/// What lies in each fourth of a row of fine cells, from the first, second, third and fourth on.
struct FineRow {
  Half first, second, third, fourth;

  HWY_INLINE explicit FineRow(const CoarseRow& row)
      : first(Mix(row.even, row.before)),
        second(Mix(row.even, row.odd)),
        third(Mix(row.odd, row.even)),
        fourth(Mix(row.odd, row.after)) {}
};

/// Which coarse cells exist: how much the two rows count, and what that sums up to.
struct Presence {
  CoarseRow near, far;
  FineRow total;

  HWY_INLINE Presence(const float* near_inverse, const float* far_inverse, std::ptrdiff_t pitch)
      : near(Existing(near_inverse, pitch, 0.75F)),
        far(Existing(far_inverse, pitch, 0.25F)),
        total(CoarseRow(hn::Add(near.even, far.even), hn::Add(near.odd, far.odd),
                        hn::Add(near.before, far.before), hn::Add(near.after, far.after))) {}

  HWY_INLINE CoarseRow Blend(const float* near_values, const float* far_values,
                             std::ptrdiff_t pitch) const {
    const auto blend = [&](Half near_weight, Half far_weight, std::ptrdiff_t i) HWY_ATTR {
      return hn::MulAdd(near_weight, hn::LoadU(Halves(), near_values + i),
                        hn::Mul(far_weight, hn::LoadU(Halves(), far_values + i)));
    };
    return {blend(near.even, far.even, 0), blend(near.odd, far.odd, pitch),
            blend(near.before, far.before, pitch - 1), blend(near.after, far.after, 1)};
  }

  /// The mean of those that exist.
  HWY_INLINE void Normalize(FineRow& row) const {
    const auto normalize = [](Half& values, Half weight) HWY_ATTR {
      values = hn::Div(values, hn::Max(weight, hn::Set(Halves(), 1e-6F)));
    };
    normalize(row.first, total.first);
    normalize(row.second, total.second);
    normalize(row.third, total.third);
    normalize(row.fourth, total.fourth);
  }

 private:
  static HWY_INLINE CoarseRow Existing(const float* inverse, std::ptrdiff_t pitch, float weight) {
    const auto existing = [&](std::ptrdiff_t i) HWY_ATTR {
      const Halves d;
      return hn::IfThenElseZero(hn::Ne(hn::LoadU(d, inverse + i), hn::Zero(d)), hn::Set(d, weight));
    };
    return {existing(0), existing(pitch), existing(pitch - 1), existing(1)};
  }
};

/// Where the coarse rows lie that a fine row lies between.
struct RowsAround {
  int near, far;

  explicit RowsAround(int y) : near(y / 2), far(y % 2 == 0 ? y / 2 - 1 : y / 2 + 1) {}
};

/// Where the coarse cells of a fine block begin, from the beginning of the row's cells.
HWY_INLINE std::ptrdiff_t CoarseStart(int fine_column) {
  return std::ptrdiff_t{lanes / 2} * fine_column;
}

/// Alternately from both: the lower and the upper half of that.
HWY_INLINE void Interleave(Half a, Half b, Half& lower, Half& upper) {
#if HWY_TARGET == HWY_SCALAR
  lower = a;
  upper = b;
#else
  const Halves d;
  lower = hn::InterleaveLower(d, a, b);
  upper = hn::InterleaveUpper(d, a, b);
  if constexpr (hn::MaxLanes(Halves()) > 4) {  // it was done in each half of 128 bits
    const Half first = lower;
    lower = hn::ConcatLowerLower(d, upper, first);
    upper = hn::ConcatUpperUpper(d, upper, first);
  }
#endif
}

/// Replaces values, or adds to them.
template <bool add>
HWY_INLINE void Put(Half step, float* target, Half& squares) {
  const Halves d;
  hn::StoreU(add ? hn::Add(hn::LoadU(d, target), step) : step, d, target);
  if (add) squares = hn::MulAdd(step, step, squares);
}
template <bool add>
HWY_INLINE void PutToCells(Half step, const float* inverse, float* target, Half& squares) {
  const Halves d;
  const auto cell = hn::Gt(hn::LoadU(d, inverse), hn::Zero(d));
  const Half old = hn::LoadU(d, target);
  hn::StoreU(hn::IfThenElse(cell, add ? hn::Add(old, step) : step, old), d, target);
  if (add) squares = hn::MulAdd(hn::IfThenElseZero(cell, step), step, squares);
}

/// The blocks [first, last) of a row, where all cells and all coarse cells around them exist.
template <bool add>
HWY_INLINE void ProlongPlain(const MembraneLevel& coarse, const float* coarse_values, int y,
                             int first, int last, const MembraneLevel& fine, float* values,
                             Half& squares) {
  const RowsAround rows(y);
  const std::ptrdiff_t count = CoarseStart(last - first);
  for (int c = 0; c < channels; ++c) {
    const float* near = coarse_values + coarse.at(rows.near, c, 0, 0) + CoarseStart(first);
    const float* far = coarse_values + coarse.at(rows.far, c, 0, 0) + CoarseStart(first);
    float* even = values + fine.at(y, c, 0, first);
    float* odd = even + fine.pitch;
    for (std::ptrdiff_t i = 0; i < count; i += HalfSize()) {
      const FineRow row(CoarseRow(near + i, far + i, coarse.pitch));
      Half lower, upper;
      Interleave(row.first, row.third, lower, upper);
      Put<add>(lower, even + 2 * i, squares);
      Put<add>(upper, even + 2 * i + HalfSize(), squares);
      Interleave(row.second, row.fourth, lower, upper);
      Put<add>(lower, odd + 2 * i, squares);
      Put<add>(upper, odd + 2 * i + HalfSize(), squares);
    }
  }
}

template <bool add>
HWY_INLINE void ProlongGeneral(const MembraneLevel& coarse, const float* coarse_values, int y,
                               int column, const MembraneLevel& fine, float* values,
                               Half& squares) {
  const RowsAround rows(y);
  const float* inverse = fine.inverse.data() + fine.at(y, 0, column);
  for (std::ptrdiff_t i = 0; i < lanes / 2; i += HalfSize()) {
    const std::ptrdiff_t start = CoarseStart(column) + i;
    const Presence presence(coarse.inverse.data() + coarse.at(rows.near, 0, 0) + start,
                            coarse.inverse.data() + coarse.at(rows.far, 0, 0) + start,
                            coarse.pitch);
    for (int c = 0; c < channels; ++c) {
      FineRow row(presence.Blend(coarse_values + coarse.at(rows.near, c, 0, 0) + start,
                                 coarse_values + coarse.at(rows.far, c, 0, 0) + start,
                                 coarse.pitch));
      presence.Normalize(row);
      float* target = values + fine.at(y, c, 0, column) + 2 * i;
      const Half* parts[2][2] = {{&row.first, &row.third}, {&row.second, &row.fourth}};
      for (int parity = 0; parity < 2; ++parity) {
        const std::ptrdiff_t to = parity * fine.pitch;
        Half lower, upper;
        Interleave(*parts[parity][0], *parts[parity][1], lower, upper);
        PutToCells<add>(lower, inverse + to + 2 * i, target + to, squares);
        PutToCells<add>(upper, inverse + to + 2 * i + HalfSize(), target + to + HalfSize(),
                        squares);
      }
    }
  }
}

template <bool add>
HWY_INLINE double ProlongRows(const MembraneLevel& coarse, const float* coarse_values, Rows rows,
                              const MembraneLevel& fine, float* values) {
  Half squares = hn::Zero(Halves());
  for (int y = rows.first; y < rows.last; ++y) {
    const RowsAround around(y);
    ForEachRun(fine, fine.stored, y, [&](Block kind, int first, int last) HWY_ATTR {
      // An error is 0 where there is no cell.
      if (add && kind == Block::plain) {
        ProlongPlain<add>(coarse, coarse_values, y, first, last, fine, values, squares);
        return;
      }
      for (int column = first; column < last; ++column) {
        if (kind == Block::plain && coarse.block(around.near, column / 2) == Block::plain &&
            coarse.block(around.far, column / 2) == Block::plain) {
          ProlongPlain<add>(coarse, coarse_values, y, column, column + 1, fine, values, squares);
        } else {
          ProlongGeneral<add>(coarse, coarse_values, y, column, fine, values, squares);
        }
      }
    });
  }
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(Halves(), squares)));
}

double Prolong(const MembraneLevel& coarse, const float* coarse_values, bool add, Rows rows,
               const MembraneLevel& fine, float* values) {
  return add ? ProlongRows<true>(coarse, coarse_values, rows, fine, values)
             : ProlongRows<false>(coarse, coarse_values, rows, fine, values);
}

void AddError(MembraneLevel& level) {
  for (int y = 0; y < level.rows(); ++y) {
    ForEachBlock(level.stored, y, [&](int column) {
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
  Half unused = hn::Zero(Halves());
  for (int y = 0; y < level.height; ++y) {
    for (int column = 0; column < level.tile_columns; ++column) {
      const Tile state = level.state(column, y / tile_height);
      if (state != Tile::smooth && state != Tile::ghost) continue;
      ProlongPlain<false>(coarse, coarse.x.data(), y, column, column + 1, level, level.x.data(),
                          unused);
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
  const RowsAround rows(y);
  for (int c = 0; c < channels; ++c) {
    const float* near = coarse.x.data() + coarse.at(rows.near, c, 0, 0) + CoarseStart(column);
    const float* far = coarse.x.data() + coarse.at(rows.far, c, 0, 0) + CoarseStart(column);
    for (std::ptrdiff_t i = 0; i < lanes / 2; i += HalfSize()) {
      const FineRow row(CoarseRow(near + i, far + i, coarse.pitch));
      hn::StoreInterleaved4(row.first, row.second, row.third, row.fourth, Halves(),
                            result + c * 2 * lanes + 4 * i);
    }
  }
}

}  // namespace
}  // namespace diminish::membrane::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish::membrane {

HWY_EXPORT(ExtendOverFixed);
HWY_EXPORT(Prolong);
HWY_EXPORT(AddError);
HWY_EXPORT(FillSmooth);
HWY_EXPORT(ReadBlock);

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
