#pragma once

#include "diminish/image.h"
#include "membrane/solver.h"

namespace diminish {

/// Writes the solution of `solver`, whose problem is the part `window` of `picture`, to the pixels
/// that were solved for; rounded to the nearest level, clamped.
void write_solution(const MembraneSolver& solver, const Rect& window, Image<Bgr>& picture);

/// Likewise the sum of `base` and the solution.
void add_solution(const MembraneSolver& solver, const Rect& window, const Image<Bgra>& base,
                  Image<Bgr>& picture);

}  // namespace diminish
