#pragma once

#include <memory>

#include "diminish/inpainter.h"

namespace diminish {

/// Whether holes are filled from their far side (FarSide, Holes::depth_m). The GPU does not do so.
enum class FillFrom { all_sides, far_side };

/// Fills each plane of the background from its own pixels alone, as smoothly as can be, and the
/// rest from what is around it.
std::unique_ptr<Inpainter> make_surface_inpainting(FillFrom from);

}  // namespace diminish
