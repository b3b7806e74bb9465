#pragma once

#include <memory>

#include "diminish/color_corrector.h"
#include "diminish/inpainter.h"
#include "membrane/solver.h"

namespace diminish {

/// The methods that solve for a membrane (poisson.cpp, harmonic_inpainting.cpp), by a given solver.
std::unique_ptr<ColorCorrector> make_poisson_correction(std::unique_ptr<MembraneSolver> solver);
std::unique_ptr<Inpainter> make_harmonic_inpainting(std::unique_ptr<MembraneSolver> solver);

}  // namespace diminish
