#include "composite/membrane_methods.h"

#include "gl/membrane_solver.h"

namespace diminish::gl {
namespace {

const bool registered =
    Registry<ColorCorrector>::add(
        "gl_poisson",
        [] { return make_poisson_correction(std::make_unique<GpuMembraneSolver>()); }) &&
    Registry<Inpainter>::add("gl_harmonic", [] {
      return make_harmonic_inpainting(std::make_unique<GpuMembraneSolver>());
    });

}  // namespace
}  // namespace diminish::gl
