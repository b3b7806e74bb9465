#pragma once

#include "diminish/membrane.h"
#include "membrane/solver.h"

namespace diminish {

/// Writes the solution of `solver` to the pixels that were solved for; rounded to the nearest
/// level, clamped. window: of the problem's size, 3 channels.
void write_solution(const MembraneSolver& solver, const Membrane::View& window);

/// Likewise the sum of `base`, of 3 or 4 channels, and the solution.
void add_solution(const MembraneSolver& solver, const Membrane::ConstView& base,
                  const Membrane::View& window);

}  // namespace diminish
