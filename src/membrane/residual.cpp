#include "membrane/kernels.h"

#include "core/neighbours.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "membrane/residual.cpp"
#include <hwy/foreach_target.h>
// Anew for each instruction set.
#include "membrane/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::membrane::HWY_NAMESPACE {
namespace {

/// The residuals of some cells of one parity, all plain. For x they have no sources.
HWY_INLINE Vector PlainResidual(const MembraneLevel& level, const float* right_side,
                                const float* values, std::ptrdiff_t at, int parity) {
  Vector sum = Neighbours(level, values, at, parity).Total();
  if (values != level.x.data()) sum = hn::Add(sum, Load(right_side + at));
  return hn::NegMulAdd(Set(4.F), Load(values + at), sum);
}

/// The same for any cells.
HWY_INLINE void Residual(const MembraneLevel& level, const float* right_side, const float* values,
                         int y, int parity, int column, std::ptrdiff_t i, Vector* result) {
  const std::ptrdiff_t single = level.at(y, parity, column) + i;
  const std::ptrdiff_t planes = level.at(y, 0, parity, column) + i;
  if (level.block(y, column) == Block::plain) {
    for (int c = 0; c < channels; ++c) {
      result[c] =
          PlainResidual(level, right_side, values, planes + c * level.channel_step(), parity);
    }
    return;
  }
  const Mask cell = hn::Gt(Load(level.inverse.data() + single), Zero());
  if (hn::AllFalse(Floats(), cell)) return;  // `result` is 0 already
  const Weights weights(level, y, parity, column, i);
  const Vector diagonal = weights.Total();
  const bool has_right_side = level.has_sources || values != level.x.data();
  for (int c = 0; c < channels; ++c) {
    const std::ptrdiff_t at = planes + c * level.channel_step();
    const Vector right = has_right_side ? Load(right_side + at) : Zero();
    const Vector sum = Neighbours(level, values, at, parity).Weighted(weights, right);
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

double RestrictResidual(const MembraneLevel& fine, const float* right_side, const float* values,
                        Rows rows, MembraneLevel& coarse) {
  HWY_ALIGN float sums[channels][2 * lanes];
  Vector squares = Zero();
  for (int y = rows.first; y < rows.last; ++y) {
    ForEachBlock(coarse.active, y, [&](int column) HWY_ATTR {
      if (coarse.block(y, column) == Block::empty) return;
      Tile states[2];
      for (int half = 0; half < 2; ++half) {
        const int fine_column = 2 * column + half;
        states[half] = StateOf(fine, 2 * y, fine_column);
        const bool active = states[half] == Tile::active;
        const bool upper = active && fine.block(2 * y, fine_column) != Block::empty;
        const bool lower = active && fine.block(2 * y + 1, fine_column) != Block::empty;
        // Black cells were relaxed last: nothing is left there. Red ones are in even columns of
        // even rows and odd columns of odd rows.
        if (active && fine.block(2 * y, fine_column) == Block::plain &&
            fine.block(2 * y + 1, fine_column) == Block::plain) {
          for (int c = 0; c < channels; ++c) {
            const std::ptrdiff_t even = fine.at(2 * y, c, 0, fine_column);
            const std::ptrdiff_t odd = fine.at(2 * y + 1, c, 1, fine_column);
            for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
              const Vector sum = hn::Add(PlainResidual(fine, right_side, values, even + i, 0),
                                         PlainResidual(fine, right_side, values, odd + i, 1));
              squares = hn::MulAdd(sum, sum, squares);
              Store(sum, sums[c] + half * lanes + i);
            }
          }
          continue;
        }
        for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
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
  /// A fine cell's difference to the one `step` further.
  float FineDifference(std::ptrdiff_t at, std::ptrdiff_t step) const {
    const float* x = fine_.x.data();
    const float difference = x[at] - x[at + step];
    return values_ ? difference + (values_[at] - values_[at + step]) : difference;
  }

  /// Of the side of a ghost tile that looks into a direction.
  void Side(int column, int row, int dx, int dy) {
    const int x = column * coarse_width + (dx > 0 ? coarse_width - 1 : 0);
    const int y = row * coarse_height + (dy > 0 ? coarse_height - 1 : 0);
    if (dx == 0) {
      for (int i = 0; i < coarse_width; ++i) {
        Cell(x + i, y, dy * coarse_.channel_row_step(),
             fine_.cell_at(2 * (x + i), 2 * y + (dy > 0 ? 1 : 0), 0), fine_.pitch,
             dy * fine_.channel_row_step());
      }
    } else {
      // A column of the other parity.
      const std::ptrdiff_t coarse_step = dx > 0 ? 1 - coarse_.pitch : coarse_.pitch - 1;
      const std::ptrdiff_t fine_step = dx > 0 ? 1 - fine_.pitch : fine_.pitch - 1;
      for (int i = 0; i < coarse_height; ++i) {
        Cell(x, y + i, coarse_step, fine_.cell_at(2 * x + (dx > 0 ? 1 : 0), 2 * (y + i), 0),
             fine_.channel_row_step(), fine_step);
      }
    }
  }

  /// step: to the cell beyond the seam. fine_at, fine_next: the two fine cells this side of it.
  void Cell(int x, int y, std::ptrdiff_t step, std::ptrdiff_t fine_at, std::ptrdiff_t fine_next,
            std::ptrdiff_t fine_step) {
    const std::ptrdiff_t at = coarse_.cell_at(x, y, 0);
    for (int c = 0; c < channels; ++c) {
      const std::ptrdiff_t own = at + c * coarse_.channel_step();
      const std::ptrdiff_t fine = fine_at + c * fine_.channel_step();
      coarse_.residual.data()[own] += coarse_.x.data()[own] - coarse_.x.data()[own + step] -
                                      FineDifference(fine, fine_step) -
                                      FineDifference(fine + fine_next, fine_step);
    }
  }

  static constexpr int coarse_width = MembraneLevel::tile_width / 2;
  static constexpr int coarse_height = tile_height / 2;

  const MembraneLevel& fine_;
  const float* values_;
  MembraneLevel& coarse_;
};

/// What fine cells inside fixed coarse cells have left over is passed on to the coarse cells beside
/// them, as much as these will change them.
void CollectFromFixed(MembraneLevel& level) {
  float* residual = level.residual.data();
  const auto share = [](Vector weight, Vector inverse) {
    const Mask from = hn::And(IsFixed(inverse), hn::Gt(weight, Zero()));
    return hn::IfThenElseZero(from, hn::Max(hn::NegMulAdd(Set(0.75F), weight, Set(1.F)), Zero()));
  };
  for (int y = 0; y < level.height; ++y) {
    ForEachBlock(level.active, y, [&](int column) HWY_ATTR {
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

void FinishResidual(const MembraneLevel& fine, const float* values, MembraneLevel& coarse) {
  if (fine.has_smooth) FluxCorrection(fine, values, coarse).Apply();
  CollectFromFixed(coarse);
}

}  // namespace
}  // namespace diminish::membrane::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish::membrane {

HWY_EXPORT(RestrictResidual);
HWY_EXPORT(FinishResidual);

double restrict_residual(const MembraneLevel& fine, const float* right_side, const float* values,
                         Rows rows, MembraneLevel& coarse) {
  return HWY_DYNAMIC_DISPATCH(RestrictResidual)(fine, right_side, values, rows, coarse);
}
void finish_residual(const MembraneLevel& fine, const float* values, MembraneLevel& coarse) {
  HWY_DYNAMIC_DISPATCH(FinishResidual)(fine, values, coarse);
}

}  // namespace diminish::membrane
#endif
