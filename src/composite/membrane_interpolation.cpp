#include "composite/membrane_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "composite/membrane_interpolation.cpp"
#include <hwy/foreach_target.h>
// Anew for each instruction set.
#include "composite/membrane_vectors-inl.h"

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
