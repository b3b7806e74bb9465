#include "membrane/kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "membrane/weights.cpp"
#include <hwy/foreach_target.h>
// Anew for each instruction set.
#include "membrane/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::membrane::HWY_NAMESPACE {
namespace {

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

/// The lanes whose bits are set, from bit i on.
HWY_INLINE Mask LoadBits(unsigned bits, std::ptrdiff_t i) {
  alignas(8) std::uint8_t bytes[8] = {};
  bytes[0] = static_cast<std::uint8_t>(bits >> i);
  bytes[1] = static_cast<std::uint8_t>(bits >> (i + 8));
  return hn::LoadMaskBits(Floats(), bytes);
}

/// `value` where the bit is set, else 0; even and odd cells apart.
HWY_INLINE void StoreBits(std::uint32_t bits, float value, float* even, std::ptrdiff_t pitch) {
  for (int parity = 0; parity < 2; ++parity) {
    const unsigned half = even_bits(bits >> parity);
    for (std::ptrdiff_t i = 0; i < lanes; i += VectorSize()) {
      Store(hn::IfThenElseZero(LoadBits(half, i), Set(value)), even + parity * pitch + i);
    }
  }
}

void SetWeights(const std::uint32_t* cells, const std::uint32_t* fixed,
                std::ptrdiff_t words_per_row, Rows rows, MembraneLevel& level) {
  const std::ptrdiff_t pitch = level.pitch;
  for (int y = rows.first; y < rows.last; ++y) {
    ForEachBlock(level.stored, y, [&](int column) {
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
    });
  }
}

void InvertDiagonal(Rows rows, MembraneLevel& level) {
  for (int y = rows.first; y < rows.last; ++y) {
    ForEachBlock(level.stored, y, [&](int column) {
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

}  // namespace
}  // namespace diminish::membrane::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish::membrane {

HWY_EXPORT(ClassifyRow);
HWY_EXPORT(SetWeights);
HWY_EXPORT(InvertDiagonal);

void classify_row(const std::uint8_t* keys, std::ptrdiff_t keys_per_row, int words,
                  std::uint32_t* cells, std::uint32_t* fixed, std::uint32_t* irregular) {
  HWY_DYNAMIC_DISPATCH(ClassifyRow)(keys, keys_per_row, words, cells, fixed, irregular);
}
void set_weights(const std::uint32_t* cells, const std::uint32_t* fixed,
                 std::ptrdiff_t words_per_row, Rows rows, MembraneLevel& level) {
  HWY_DYNAMIC_DISPATCH(SetWeights)(cells, fixed, words_per_row, rows, level);
}
void invert_diagonal(Rows rows, MembraneLevel& level) {
  HWY_DYNAMIC_DISPATCH(InvertDiagonal)(rows, level);
}

}  // namespace diminish::membrane
#endif
