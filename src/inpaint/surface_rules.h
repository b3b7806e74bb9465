#pragma once

#include "diminish/reconstruction.h"
#include "inpaint/plane_colors.h"

namespace diminish::surface_rules {

// What the processor's inpainting by surfaces and the GPU's go by.

/// Labels that are filled from their own pixels, and `unknown`.
inline constexpr int labels = surface_label::first_plane + PlaneColors::planes;
/// Of a hole's rim on measured surfaces, at least so much must lie on the hole's plane; else the
/// hole is rather one in what stands in front of it.
inline constexpr int plane_rim_percent = 60;
/// A pixel that is darker than this share of its plane's colour around it lies in the contact
/// shadow of the object, which goes with it.
inline constexpr float shadow = 0.85F;

}  // namespace diminish::surface_rules
