#pragma once

#include <cstddef>
#include <cstdint>

#include "core/rows.h"
#include "membrane/level.h"

namespace diminish::membrane {

// The inner loops of MembraneSolver, vectorised for whatever the CPU has. `values` and
// `right_side` are a level's x and right_side, or its error and residual.

/// The key of a pixel with a given value (Dirichlet).
inline constexpr std::uint8_t fixed_value_key = 255;

/// Every second bit, beginning with the lowest, moved together.
inline std::uint32_t even_bits(std::uint32_t bits) {
  bits &= 0x55555555U;
  bits = (bits | bits >> 1) & 0x33333333U;
  bits = (bits | bits >> 2) & 0x0F0F0F0FU;
  bits = (bits | bits >> 4) & 0x00FF00FFU;
  return (bits | bits >> 8) & 0xFFFFU;
}

/// Sorts the keys of a row, 32 pixels a word: into cells (neither 0 nor fixed), fixed pixels beside
/// a cell, and those cells that are irregular, i.e. have a neighbour of another key.
/// keys: the row's first; the rows above and below and a key on both sides must be readable.
void classify_row(const std::uint8_t* keys, std::ptrdiff_t keys_per_row, int words,
                  std::uint32_t* cells, std::uint32_t* fixed, std::uint32_t* irregular);

/// Sets the weights of the stored blocks of the finest level: 1 between neighbouring cells and from
/// cells to fixed pixels; marks the fixed pixels.
/// cells, fixed: as from classify_row, with a margin of one word and one row of zeros.
void set_weights(const std::uint32_t* cells, const std::uint32_t* fixed,
                 std::ptrdiff_t words_per_row, Rows rows, MembraneLevel& level);

/// Makes the coarser level's weights, right side and fixed values: a cell of 2x2. rows: of the
/// coarser level.
void coarsen(const MembraneLevel& fine, Rows rows, MembraneLevel& coarse);

/// Computes `inverse` from the weights.
void invert_diagonal(Rows rows, MembraneLevel& level);

/// One red-black Gauss-Seidel sweep over the active tiles. from_zero: whatever is in `values`, take
/// it for 0. Leaves half of the first and of the last row to relax_seam, unless they are the
/// level's.
void relax(const MembraneLevel& level, const float* right_side, float* values, bool from_zero,
           Rows rows);
/// The rest of a sweep, where rows before `row` and from `row` on were relaxed apart.
void relax_seam(const MembraneLevel& level, const float* right_side, float* values, bool from_zero,
                int row);

/// coarse.residual = what is left of the fine equations after `relax`, summed over 2x2 cells, in
/// rows of the coarser level. Returns the sum of its squares. Then, once, finish_residual.
double restrict_residual(const MembraneLevel& fine, const float* right_side, const float* values,
                         Rows rows, MembraneLevel& coarse);
void finish_residual(const MembraneLevel& fine, const float* values, MembraneLevel& coarse);

/// Continues `values` over fixed cells, so that they interpolate well. To be called once `values`
/// are relaxed for the last time.
void extend_over_fixed(const MembraneLevel& level, float* values);

/// Bilinear interpolation from the coarse level's cells that exist to the fine level's stored
/// blocks; replaces `values` or adds to them. Returns the sum of squares of what was added.
/// rows: of the fine level.
double prolong(const MembraneLevel& coarse, const float* coarse_values, bool add, Rows rows,
               const MembraneLevel& fine, float* values);

/// Adds `error` to `x` in the stored blocks.
void add_error(MembraneLevel& level);

/// Sets x in the smooth tiles that are not stored, from the next level.
void fill_smooth(MembraneLevel& level, const MembraneLevel& coarse);

/// x in the 32 pixels of a block, stored or not; `coarse` is the next level. result: three channels
/// of 32.
void read_block(const MembraneLevel& level, const MembraneLevel& coarse, int y, int column,
                float* result);

}  // namespace diminish::membrane
