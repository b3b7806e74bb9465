#pragma once

#include "diminish/surfaces.h"
#include "inpaint/plane_colors.h"

namespace diminish::surface_rules {

// Rules of inpainting by surfaces, shared by the CPU and the GPU.

/// The labels that are filled from their own pixels, and `unknown`.
inline constexpr int labels = surface_label::first_plane + PlaneColors::planes;
/// At least this share of a hole's rim on measured surfaces must lie on the hole's plane. Otherwise
/// the hole is more likely one in something in front of the plane.
inline constexpr int plane_rim_percent = 60;
/// A pixel that is darker than this share of its plane's colour around it lies in the object's
/// contact shadow, which disappears with the object.
inline constexpr float shadow = 0.85F;

}  // namespace diminish::surface_rules
